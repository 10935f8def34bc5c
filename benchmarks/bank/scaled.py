"""A robot of another size that does the same: lengths, masses and times in proportion, accelerations as they are.

Under gravity a robot λ times as long is the same robot where its times are √λ as long and its forces grow as its mass:
what its accelerometer reads is one curve over t/√λ (Froude). Noise and mains are the sensor's, and stay.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ssmr_ident.core.parameter import Estimate, ParameterSet


@dataclass(frozen=True)
class Scale:
    """So many times the mass and the length."""

    mass: float = 1.0
    length: float = 1.0

    @property
    def time(self) -> float:
        return self.length**0.5

    def factor(self, unit: str) -> float:
        """By what a value in a unit grows.

        Raises
        ------
        KeyError
            A unit that no robot's file has.
        """
        mass, length, time = self.mass, self.length, self.time
        grows = {
            **{"kg": mass, "kg m^2": mass * length**2, "m": length, "Hz": 1.0 / time, "1/s": 1.0 / time},
            **{"N/m": mass / length, "N s/m": mass / time},
            **dict.fromkeys(("1", "V", "V s^2/m", "m/s^2"), 1.0),
        }
        return grows[unit]

    def known(self, file: ParameterSet) -> ParameterSet:
        """What is known of the scaled robot, as well as it was of the other."""

        def grown(estimate: Estimate) -> Estimate:
            own, std = self.factor(estimate.unit), estimate.std
            return replace(estimate, value=own * estimate.value, std=None if std is None else own * std)

        return replace(file, estimates={path: grown(estimate) for path, estimate in file.items()})


AS_IT_IS = Scale()
