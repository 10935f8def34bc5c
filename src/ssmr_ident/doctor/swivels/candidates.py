"""Explanations that a swivel can be given: effects of the catalogue, where to start, and how large they may be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Values = dict[str, float]
UNLISTED = "unlisted"
UNLISTED_LAWS = {
    "k3_N_m3": "nonlinear_stiffness", "d2_N_s2_m2": "quadratic_damping", "alpha": "hysteresis", "yield_m": "hysteresis",
}  # fmt: skip
"""Laws of a tire that are on no list for swivels, by the parameters that are searched."""


@dataclass(frozen=True)
class Free:
    """A parameter that is searched: its bounds, whether on a logarithmic scale, and how far off it may still be.

    ``unsure`` is a standard deviation of the logarithm, or of a fifth of the span; what places lines in a spectrum is
    found by them, to less than they are wide.
    """

    name: str
    lower: float
    upper: float
    log: bool = True
    unsure: float = 0.2

    def inward(self, value: float) -> float:
        return float(np.log(value)) if self.log else value

    def outward(self, position: float) -> float:
        value = float(np.exp(position)) if self.log else position
        return float(np.clip(value, self.lower, self.upper))

    @property
    def spread(self) -> float:
        """Standard deviation on the scale of the search by which a start may be off."""
        return self.unsure if self.log else 0.2 * self.unsure * self.span

    @property
    def span(self) -> float:
        return self.inward(self.upper) - self.inward(self.lower)


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect with starts of the search; ``held`` are parameters that it keeps."""

    id: str
    free: tuple[Free, ...]
    starts: tuple[Values, ...]
    held: Mapping[str, float]

    def effects(self, values: Values) -> dict[str, Values]:
        """As the simulator takes them; what is unlisted is a law of the tires: a smooth force, or one with loops."""
        if self.id == UNLISTED:
            laws: dict[str, Values] = {}
            for name, value in values.items():
                laws.setdefault(UNLISTED_LAWS[name], {})[name] = value
            return laws
        return {self.id: {**self.held, **values}}

    def position(self, values: Values) -> np.ndarray:
        """(p,) float: the values on the scales of the search."""
        return np.array([free.inward(values[free.name]) for free in self.free])

    def values(self, position: np.ndarray) -> Values:
        return {free.name: free.outward(float(x)) for free, x in zip(self.free, position, strict=True)}


def _grid(**axes: tuple[float, ...]) -> tuple[Values, ...]:
    points: list[Values] = [{}]
    for name, values in axes.items():
        points = [{**point, name: value} for point in points for value in values]
    return tuple(points)


def candidates(pitches: tuple[float, ...], ceilings: tuple[float, ...], grain: float) -> tuple[Candidate, ...]:
    """All explanations.

    Parameters
    ----------
    pitches : tuple of float [m]
        Joint distances that lines in the spectra speak for.
    ceilings : tuple of float [m/s^2]
        Levels at which recordings may have been cut off.
    grain : float [m]
        Rms height of the baseline's own floor.
    """
    heights = tuple(height for height in (6e-5, 1.2e-4, 2.5e-4, 5e-4, 1e-3) if height > 1.3 * grain)
    tilts = [dict.fromkeys(("angle_x_rad", "angle_y_rad", "angle_z_rad"), 0.0) for _ in range(12)]
    for i, tilt in enumerate(tilts):
        tilt[("angle_x_rad", "angle_y_rad", "angle_z_rad")[i // 4]] = (-0.2, -0.07, 0.07, 0.2)[i % 4]
    shifts = [{"offset_x_m": x, "offset_y_m": y} for x in (-0.04, -0.015, 0.0, 0.015, 0.04) for y in (-0.03, 0.0, 0.03)]
    return (
        Candidate(
            "ground_roughness",
            (Free("height_m", 1e-6, 0.02), Free("length_m", 0.006, 0.5)),
            _grid(height_m=heights, length_m=(0.006, 0.015, 0.04, 0.1)),
            {},
        ),
        Candidate(
            "ground_joints",
            (Free("depth_m", 1e-6, 0.02), Free("pitch_m", 3e-3, 2.0, unsure=0.04), Free("width_m", 2e-3, 0.03)),
            _grid(pitch_m=pitches, depth_m=(8e-5, 2e-4, 5e-4, 1.2e-3), width_m=(6e-3,)),
            {},
        ),
        Candidate(
            "wheel_eccentricity",
            (Free("eccentricity_m", 1e-6, 0.02),),
            _grid(eccentricity_m=(1e-4, 2e-4, 4e-4, 8e-4, 1.6e-3, 3.2e-3)),
            {},
        ),
        Candidate(
            "flexible_mast",
            (
                Free("f_mast_Hz", 2.0, 40.0, unsure=0.07),
                Free("mass_kg", 0.1, 8.0),
                Free("height_above_com_m", 0.05, 1.5, unsure=0.25),
                Free("damping_ratio", 0.002, 0.3, unsure=0.5),
            ),
            # a sway is a few per cent wide: starts further apart than this are no starts
            _grid(
                f_mast_Hz=tuple(3.5 * 1.16**i for i in range(12)),
                mass_kg=(1.0, 2.5, 4.5),
                height_above_com_m=(0.25, 0.4),
                damping_ratio=(0.03,),
            ),
            {},
        ),
        Candidate(
            "com_offset",
            (Free("offset_x_m", -0.15, 0.15, log=False), Free("offset_y_m", -0.15, 0.15, log=False)),
            tuple(shift for shift in shifts if any(shift.values())),
            {},
        ),
        Candidate("wheel_lift", (), ({},), {"active": 1.0}),
        Candidate(
            "motor_belt",
            (Free("K_b_N_m", 500.0, 1e6), Free("D_b_N_s_m", 2.0, 500.0)),
            _grid(K_b_N_m=tuple(1e3 * 1.4**i for i in range(12)), D_b_N_s_m=(50.0,)),
            {"rim_mass_kg": 1.0},
        ),
        Candidate(
            "stribeck",
            (Free("kinetic_share", 0.1, 1.0), Free("stribeck_velocity_m_s", 3e-3, 1.0)),
            _grid(kinetic_share=(0.65, 0.85), stribeck_velocity_m_s=(0.01, 0.04, 0.12, 0.3)),
            {},
        ),
        Candidate(
            "load_sensitive_friction",
            (Free("exponent", -0.3, 0.9, log=False),),
            _grid(exponent=(0.1, 0.2, 0.35, 0.55)),
            {},
        ),
        Candidate(
            "slip_coupling",
            (Free("lambda_max", 0.05, 1.0),),
            _grid(lambda_max=(0.35, 0.5, 0.65, 0.8, 1.0)),
            {"weight": 1.0},
        ),
        Candidate("rolling_resistance", (Free("c_rr", 1e-3, 0.5),), _grid(c_rr=(0.01, 0.03, 0.06, 0.12, 0.25)), {}),
        Candidate("coriolis", (), ({},), {"share": 1.0}),
        Candidate(
            "sensor_saturation", (Free("range_m_s2", 0.2, 50.0),), _grid(range_m_s2=ceilings), {"range_N": float("inf")}
        ),
        Candidate(
            "sensor_bandwidth",
            (Free("bandwidth_hz", 3.0, 80.0),),
            _grid(bandwidth_hz=(6.0, 10.0, 15.0, 22.0, 30.0, 45.0)),
            {},
        ),
        Candidate(
            "sensor_misalignment",
            tuple(Free(f"angle_{axis}_rad", -0.5, 0.5, log=False) for axis in "xyz"),
            tuple(tilts),
            {},
        ),
        Candidate(
            UNLISTED,
            (Free("k3_N_m3", 1e6, 2e10), Free("d2_N_s2_m2", 1.0, 5e4)),
            _grid(k3_N_m3=(1e6, 5e8, 3e9), d2_N_s2_m2=(1.0, 400.0, 1.5e3))[1:],
            {},
        ),
        Candidate(
            UNLISTED,
            (Free("alpha", 0.05, 0.99), Free("yield_m", 3e-5, 2e-2)),
            # tires that skid are deflected by a millimetre or two
            _grid(alpha=(0.45, 0.75), yield_m=(2e-4, 8e-4, 3e-3)),
            {},
        ),
    )


LEVERS = 5  # harmonics of a line that are looked for


def pitches_heard(
    frequency: np.ndarray, excess: list[np.ndarray], path_speeds: list[float], count: int = 6
) -> tuple[float, ...]:
    """Joint distances whose lines stand out of the spectra at all speeds together.

    Parameters
    ----------
    frequency : (k,) float [Hz]
    excess : list of (k,) float
        Logarithm of measured over predicted density, mean over channels, one per condition.
    path_speeds : list of float [m/s]
        Of the contacts over the floor.
    count : int
    """
    trial = np.geomspace(4e-3, 0.6, 400)
    total = np.zeros(len(trial))
    for course, speed in zip(excess, path_speeds, strict=True):
        course = np.clip(course - np.median(course), -3.0, 3.0)
        for harmonic in range(1, LEVERS + 1):
            line = harmonic * abs(speed) / trial
            inside = (line >= frequency[0]) & (line <= frequency[-1])
            total += np.where(inside, np.interp(line, frequency, course) / harmonic, 0.0)
    chosen: list[float] = []
    for i in np.argsort(total)[::-1]:
        if _apart(float(trial[i]), chosen):
            chosen.append(float(trial[i]))
        if len(chosen) == count:
            break
    # every second or third line of wide joints looks like all lines of narrow ones
    chosen += [wide for pitch in chosen[:2] for wide in (2.0 * pitch, 3.0 * pitch) if _apart(wide, chosen)]
    return tuple(sorted(chosen))


def _apart(pitch: float, others: list[float]) -> bool:
    return all(abs(np.log(pitch / other)) > 0.06 for other in others)
