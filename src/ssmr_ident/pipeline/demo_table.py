"""Published, identified and simulated values side by side."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.pipeline.fit import SessionFit


@dataclass(frozen=True)
class DemoRow:
    """One quantity: as the thesis prints it, as identified from the logs, and from the simulator's own logs."""

    quantity: str
    unit: str
    thesis: str
    identified: float
    std: float | None
    simulated: float | None


@dataclass(frozen=True)
class DemoTable:
    """The table that the main job ends in."""

    rows: tuple[DemoRow, ...]

    def cells(self) -> tuple[tuple[str, ...], ...]:
        """As text: quantity with unit, thesis, identified, simulated."""
        return tuple(
            (f"{r.quantity} [{r.unit}]", r.thesis, _with_std(r.identified, r.std), _plain(r.simulated))
            for r in self.rows
        )

    def as_list(self) -> list[dict[str, Any]]:
        """For ``--json``."""
        return [
            {"quantity": r.quantity, "unit": r.unit, "thesis": r.thesis, "identified": r.identified,
             "std": r.std, "simulated": r.simulated}
            for r in self.rows
        ]  # fmt: skip

    def __str__(self) -> str:
        header = ("quantity", "thesis", "identified", "simulated")
        cells = (header, *self.cells())
        widths = [max(len(row[column]) for row in cells) for column in range(4)]
        return "\n".join(
            "  ".join(
                cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))
            )
            for row in cells
        )


def demo_table(
    published: Path, pulls: SessionFit, carpet: SessionFit, decays: SessionFit, simulated: SessionFit
) -> DemoTable:
    """Gather the table.

    Parameters
    ----------
    published : Path
        Folder of the thesis' numbers as CSV.
    pulls, carpet, decays : SessionFit
        Of the recordings.
    simulated : SessionFit
        Of the simulator's own logs.

    Raises
    ------
    InputError
        A published table is missing.
    """
    motions = _by_key(published / "modes-5-9.csv", "motion")
    rows = []
    for motion in ("roll", "pitch", "yaw"):
        own = [r for r in decays.results.values() if r.get("motion") == motion]
        made = [r for r in simulated.results.values() if r.get("motion") == motion]
        for key, name, unit, column in (
            ("omega_n_rad_s", "natural frequency", "rad/s", "omega_n_rad_s"),
            ("xi", "damping ratio", "1", "xi"),
        ):
            mean, std = _mean([r[key] for r in own])
            rows.append(
                DemoRow(f"{motion}: {name}", unit, motions[motion][column], mean, std, _mean([r[key] for r in made])[0])
            )
    force = _by_key(published / "forces-3-3.csv", "quantity")
    for quantity, key, printed in (
        ("tire stiffness y", "tire.stiffness_y_N_m", force["tire_stiffness_y"]),
        ("tire stiffness z", "tire.stiffness_z_N_m", force["tire_stiffness_z"]),
    ):
        estimate = pulls.parameters[key]
        made = float(simulated.parameters[key].value)
        rows.append(DemoRow(quantity, "N/m", printed["low"], float(estimate.value), estimate.std, made))
    rows.append(_belt(force["belt_stiffness"]["low"], pulls, simulated))
    for floor, fit in (("concrete", pulls), ("carpet", carpet)):
        estimate = fit.parameters["tire.mu_static"]
        made = float(simulated.parameters["tire.mu_static"].value) if fit is pulls else None
        printed = force[f"mu_static_{floor}"]["low"]
        rows.append(DemoRow(f"static friction, {floor}", "1", printed, float(estimate.value), estimate.std, made))
    for axis, printed in _inertias(published):
        estimate = decays.parameters[f"inertia_kg_m2.{axis}"]
        rows.append(DemoRow(f"inertia {axis}", "kg m²", printed, float(estimate.value), estimate.std, None))
    damping = _by_key(published / "damping-6-5.csv", "quantity")
    for axis in "xyz":
        estimate = decays.parameters[f"tire.damping_{axis}_N_s_m"]
        made = float(simulated.parameters[f"tire.damping_{axis}_N_s_m"].value)
        rows.append(
            DemoRow(
                f"tire damping {axis}",
                "N s/m",
                damping[f"damping_{axis}"]["value"],
                float(estimate.value),
                estimate.std,
                made,
            )
        )
    estimate = decays.parameters["mass_kg"]
    rows.append(DemoRow("mass", "kg", "not printed", float(estimate.value), estimate.std, None))
    return DemoTable(tuple(rows))


def _belt(printed: str, pulls: SessionFit, simulated: SessionFit) -> DemoRow:
    """(3.8): the first rise of a lengthwise pull with the stiff cable is twice a belt's stiffness."""

    def rises(fit: SessionFit) -> list[float]:
        chosen = [r for file, r in fit.results.items() if r.get("direction") == "longitudinal" and "rope" not in file]
        return [0.5 * r["first_rise_N_m"] for r in chosen if r["load_N"] > 250.0]

    mean, std = _mean(rises(pulls))
    return DemoRow("belt, eq (3.8)", "N/m", printed, mean, std, _mean(rises(simulated))[0])


def _inertias(published: Path) -> list[tuple[str, str]]:
    rows = _by_key(published / "inertia-5-1.csv", "element")
    return [(axis, rows[axis]["cad_kg_m2"]) for axis in ("xx", "yy", "zz")]


def _by_key(path: Path, key: str) -> Mapping[str, Mapping[str, str]]:
    if not path.is_file():
        raise InputError(str(path), "no such file", "Take the data folder of the checkout")
    with path.open(encoding="utf-8", newline="") as stream:
        return {row[key]: row for row in csv.DictReader(stream)}


def _mean(values: Sequence[float]) -> tuple[float, float | None]:
    """Mean, and the standard deviation of single trials."""
    return float(np.mean(values)), float(np.std(values, ddof=1)) if len(values) > 1 else None


def _plain(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def _with_std(value: float, std: float | None) -> str:
    return _plain(value) if std is None else f"{_plain(value)} ± {std:.2g}"
