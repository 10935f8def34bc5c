"""A sheet of lengths, weighings and parts: centre of mass, contact points and inertia with their uncertainties."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError, did_you_mean
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.core.shown import Shown
from ssmr_ident.identify.geometry.mass_properties import (
    Component,
    Measured,
    assemble,
    box,
    from_two_weighings,
    height_from_tilting,
)
from ssmr_ident.identify.lmfit_report import Variable, variables_report

Array = np.ndarray

SCHEMA = "ssmr-ident/measurements/1"

_TOP = {"schema", "name", "wheelbase_m", "track_m", "weighing", "tilting", "components"}
_PART = {"name", "mass_kg", "mass_std_kg", "size_m", "place_m", "place_std_m", "inertia_kg_m2"}

DRAWS = 4000
"""Draws by which the uncertainty of parts becomes one of the inertia: a std known to 1 %."""


@dataclass(frozen=True, eq=False)
class RobotGeometry(Shown):
    """What a sheet of measurements gives.

    Parameters
    ----------
    name : str
    rear, height, left : Measured or None
        Of the centre of mass: from the rear axle, above the floor, to the left of the middle.
    contact_points, contact_std : (4, 3) float [m] or None, float [m]
        From the centre of mass; rear left, front left, front right, rear right.
    mass, mass_std : float [kg]
    inertia, inertia_std : (3, 3) float [kg m^2] or None
        About the centre of mass of the parts.
    place : (3,) float [m] or None
        Of the parts' centre of mass, in their own frame.
    """

    name: str
    rear: Measured | None
    height: Measured | None
    left: Measured | None
    contact_points: Array | None
    contact_std: float
    mass: float
    mass_std: float
    inertia: Array | None
    inertia_std: Array | None
    place: Array | None

    def parameters(self) -> ParameterSet:
        """Entries for robot.yaml."""
        found: dict[str, Estimate] = {}
        if self.mass > 0:
            std = self.mass_std if self.mass_std > 0 else None
            found["mass_kg"] = Estimate(self.mass, std, "kg", "weighed")
        if self.inertia is not None and self.inertia_std is not None:
            for i, j, axes in ((0, 0, "xx"), (1, 1, "yy"), (2, 2, "zz"), (0, 1, "xy"), (0, 2, "xz"), (1, 2, "yz")):
                std = float(self.inertia_std[i, j])
                found[f"inertia_kg_m2.{axes}"] = Estimate(
                    float(self.inertia[i, j]), std if std > 0 else None, "kg m^2", "components and parallel axes (5.1)"
                )
        if self.contact_points is not None:
            found["contact_points_m"] = Estimate(self.contact_points, self.contact_std, "m", "weighed and tilted")
        return ParameterSet(self.name, found)

    def __str__(self) -> str:
        rows = []
        for name, measured in (("from rear axle", self.rear), ("height", self.height), ("to the left", self.left)):
            if measured is not None:
                rows.append(Variable(name, measured.value, measured.std, "m"))
        if self.mass > 0:
            rows.append(Variable("mass", self.mass, self.mass_std or None, "kg"))
        if self.inertia is not None and self.inertia_std is not None:
            for i, j, axes in ((0, 0, "xx"), (1, 1, "yy"), (2, 2, "zz"), (0, 1, "xy"), (0, 2, "xz"), (1, 2, "yz")):
                std = float(self.inertia_std[i, j])
                rows.append(Variable(f"inertia {axes}", float(self.inertia[i, j]), std or None, "kg m^2"))
        lines = [f"[[Geometry]] {self.name}", *variables_report(rows)]
        if self.place is not None:
            place = ", ".join(f"{value:+.4f}" for value in self.place)
            lines.append(f"    the parts' centre of mass lies at ({place}) m in their own frame")
        if self.contact_points is not None:
            lines.append("    contact points from the centre of mass [m], in the order of Table 5.1:")
            lines += ["        " + "  ".join(f"{value:+.4f}" for value in row) for row in self.contact_points]
        return "\n".join(lines)


def robot_geometry(sheet: Mapping[str, Any], where: str, seed: int = 0) -> RobotGeometry:
    """Work a sheet of measurements out.

    Parameters
    ----------
    sheet : mapping
        As ``docs/howto/measurements.yaml`` shows.
    where : str
        File, for messages.
    seed : int
        Of the draws by which the parts' uncertainty becomes that of the inertia.

    Raises
    ------
    InputError
        Names the key and the mend.
    """
    for key in sheet:
        if key not in _TOP:
            raise InputError(f"{where}: {key}", "is not a known key", did_you_mean(str(key), _TOP))
    if sheet.get("schema", SCHEMA) != SCHEMA:
        raise InputError(f"{where}: schema", f"is {sheet['schema']!r}, expected {SCHEMA!r}", "Is this the right file?")
    base, base_std = _with_std(sheet, "wheelbase_m", where)
    track, track_std = _with_std(sheet, "track_m", where)
    rear = mass = mass_std = None
    if "weighing" in sheet:
        block = _block(sheet, "weighing", {"front_kg", "rear_kg", "std_kg"}, where)
        front, back, std = (_number(block, key, f"{where}: weighing") for key in ("front_kg", "rear_kg", "std_kg"))
        rear = from_two_weighings(front, back, _needed(base, "wheelbase_m", where), std, base_std)
        mass, mass_std = front + back, std * np.sqrt(2.0)
    height = left = None
    if "tilting" in sheet:
        block = _block(sheet, "tilting", {"left_deg", "right_deg", "std_deg"}, where)
        angles = [np.radians(_number(block, key, f"{where}: tilting")) for key in ("left_deg", "right_deg", "std_deg")]
        half = _needed(track, "track_m", where) / 2
        height, left = height_from_tilting(angles[0], angles[1], half, angles[2], track_std / 2)
    points, point_std = None, 0.0
    if rear is not None and height is not None and left is not None:
        front_x, half = float(base or 0.0) - rear.value, float(track or 0.0) / 2
        ends = [(-rear.value, half), (front_x, half), (front_x, -half), (-rear.value, -half)]
        points = np.array([[x, y - left.value, -height.value] for x, y in ends])
        point_std = max(rear.std, height.std, left.std)
    whole, spread, part_mass_std = _parts(sheet.get("components", []), where, seed)
    if whole is not None and mass is None:
        mass, mass_std = whole.mass, part_mass_std
    if rear is None and height is None and whole is None:
        raise InputError(where, "holds neither weighing, tilting nor components", "See docs/howto/measurements.yaml")
    return RobotGeometry(
        name=str(sheet.get("name", "robot")),
        rear=rear,
        height=height,
        left=left,
        contact_points=points,
        contact_std=float(point_std),
        mass=float(mass or 0.0),
        mass_std=float(mass_std or 0.0),
        inertia=None if whole is None else whole.inertia,
        inertia_std=spread,
        place=None if whole is None else whole.place,
    )


def _parts(rows: Any, where: str, seed: int) -> tuple[Component | None, Array | None, float]:
    """Components put together, the standard deviation of their inertia, and that of their mass."""
    if not rows:
        return None, None, 0.0
    parts, spreads = [], []
    for number, row in enumerate(rows, 1):
        place = f"{where}: components[{number}]"
        for key in row:
            if key not in _PART:
                raise InputError(f"{place}.{key}", "is not a known key", did_you_mean(str(key), _PART))
        mass, at = _number(row, "mass_kg", place), _vector(row, "place_m", place)
        if "inertia_kg_m2" in row:
            part = Component(mass, at, np.diag(_vector(row, "inertia_kg_m2", place)))
        else:
            part = box(mass, _vector(row, "size_m", place).tolist(), at.tolist())
        parts.append(part)
        spreads.append((float(row.get("mass_std_kg", 0.0)), float(row.get("place_std_m", 0.0))))
    rng = np.random.default_rng(seed)
    drawn = []
    for _ in range(DRAWS if any(any(spread) for spread in spreads) else 0):
        moved = []
        for part, (mass_std, place_std) in zip(parts, spreads, strict=True):
            mass = max(part.mass + mass_std * rng.standard_normal(), 1e-6)
            # a part's own inertia goes with its mass
            moved.append(
                Component(mass, part.place + place_std * rng.standard_normal(3), part.inertia * mass / part.mass)
            )
        drawn.append(assemble(moved).inertia)
    spread = np.std(drawn, axis=0, ddof=1) if drawn else np.zeros((3, 3))
    return assemble(parts), spread, float(np.sqrt(sum(mass_std**2 for mass_std, _ in spreads)))


def _block(sheet: Mapping[str, Any], key: str, known: set[str], where: str) -> Mapping[str, Any]:
    block = sheet[key]
    if not isinstance(block, Mapping):
        raise InputError(f"{where}: {key}", "must be a mapping", f"Write {', '.join(sorted(known))} under it")
    for name in block:
        if name not in known:
            raise InputError(f"{where}: {key}.{name}", "is not a known key", did_you_mean(str(name), known))
    return block


def _with_std(sheet: Mapping[str, Any], key: str, where: str) -> tuple[float | None, float]:
    if key not in sheet:
        return None, 0.0
    entry = sheet[key]
    if isinstance(entry, Mapping):
        return _number(entry, "value", f"{where}: {key}"), float(entry.get("std", 0.0))
    return _number(sheet, key, where), 0.0


def _needed(value: float | None, key: str, where: str) -> float:
    if value is None:
        raise InputError(f"{where}: {key}", "is missing", f"Write {key}: {{value: 0.28, std: 0.001}}")
    return value


def _number(block: Mapping[str, Any], key: str, where: str) -> float:
    if key not in block:
        raise InputError(f"{where}.{key}", "is missing", "See docs/howto/measurements.yaml")
    value = block[key]
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise InputError(f"{where}.{key}", f"is {value!r}, expected a number", "Use a decimal point, no unit")
    return float(value)


def _vector(block: Mapping[str, Any], key: str, where: str) -> Array:
    value = block.get(key)
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{where}.{key}", f"is {value!r}, expected three numbers", "Write [x, y, z]")
    return np.array([_number({key: part}, key, where) for part in value])
