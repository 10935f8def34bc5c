"""A hidden effect: what the truth says of it, and what it does to the plant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ssmr_proof.plant.robot_model import Frame, Turned

UNITS = {
    **{"k3_N_m3": "N/m^3", "F_c_N": "N", "element_stiffness_N_m": "N/m", "d2_N_s2_m2": "N s^2/m^2"},
    **{"K_m_N_m": "N/m", "tau_s": "s", "yield_m": "m", "gap_m": "m", "f_mast_Hz": "Hz", "mass_kg": "kg"},
    **{"height_above_com_m": "m", "K_cable_N_m": "N/m", "zero_drift_N_s": "N/s", "gain_drift_1_s": "1/s"},
    **{"stribeck_velocity_m_s": "m/s", "range_m_s2": "m/s^2", "range_N": "N", "bandwidth_hz": "Hz"},
    **{"offset_x_m": "m", "offset_y_m": "m", "knee_m": "m", "pulse_Hz": "Hz"},
    **{"reach_1_m2": "1/m^2", "root_N_s05_m05": "N s^0.5/m^0.5"},
    **{f"angle_{axis}_rad": "rad" for axis in "xyz"},
}


@dataclass(frozen=True)
class Change:
    """What an effect changes in the plant; what is left at its default is not touched.

    Parameters
    ----------
    laws : mapping of law to value
        Of `plant.spring_laws`.
    frame, turned : optional
    offset_m : (float, float)
        Where the centre of mass is from where the file has it.
    bandwidth_hz, range : float
        Of the sensor, in its unit.
    cable_stiffness, zero_drift, gain_drift, kinetic_share, slip_speed, load_exponent : float
    loud : float
        Factor on the pushes that start decays.
    absorber : (float, float, float)
        Share of the mass, frequency [Hz], damping ratio of a second mass on a rig.
    """

    laws: Mapping[str, float] = field(default_factory=dict)
    frame: Frame | None = None
    turned: Turned | None = None
    offset_m: tuple[float, float] = (0.0, 0.0)
    bandwidth_hz: float | None = None
    range: float | None = None
    cable_stiffness: float | None = None
    zero_drift: float = 0.0
    gain_drift: float = 0.0
    kinetic_share: float = 1.0
    slip_speed: float = 1.0
    load_exponent: float = 0.0
    loud: float = 1.0
    absorber: tuple[float, float, float] = (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Hidden:
    """One effect of a truth.

    Parameters
    ----------
    id : str
        Of effects.md, or ``unlisted``.
    form : str
        Which formula of it.
    parameters : mapping of str to float
        Under the catalogue's names where the formula is the catalogue's, SI.
    how : str
        In words.
    change : Change
    strength : float
        0 at the weakest drawn, 1 at the strongest.
    also : tuple of str
        Other ids that name the same physics.
    """

    id: str
    form: str
    parameters: Mapping[str, float]
    how: str
    change: Change
    strength: float = 1.0
    also: tuple[str, ...] = ()

    @property
    def accepted(self) -> tuple[str, ...]:
        """Ids that count as right."""
        return (self.id, *self.also)

    def as_dict(self) -> dict[str, Any]:
        """As in truth.json."""
        return {
            "id": self.id,
            "form": self.form,
            "parameters": {
                name: {"value": float(value), "unit": UNITS.get(name, "1")} for name, value in self.parameters.items()
            },
            "how": self.how,
            "strength": float(self.strength),
            **({"accepted": list(self.accepted)} if self.also else {}),
        }


def combined(effects: tuple[Hidden, ...]) -> Change:
    """All changes at once; of what both set, the later holds (cases are drawn so that none is set twice)."""
    merged: dict[str, Any] = {"laws": {}}
    default = Change()
    for effect in effects:
        merged["laws"] |= dict(effect.change.laws)
        for name in Change.__dataclass_fields__:
            value = getattr(effect.change, name)
            if name != "laws" and value != getattr(default, name):
                merged[name] = value
    return Change(**merged)
