"""Published, identified and simulated values side by side."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.shown import Shown
from ssmr_ident.report.numbers import NONE, measured, unit
from ssmr_ident.workflows.fit.result import SessionFit


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
class DemoTable(Shown):
    """The table that the main job ends in."""

    rows: tuple[DemoRow, ...]

    def cells(self) -> tuple[tuple[str, ...], ...]:
        """As text: quantity with unit, thesis, identified, simulated."""
        return tuple(
            (f"{r.quantity} [{unit(r.unit) or NONE}]", r.thesis, measured(r.identified, r.std), _plain(r.simulated))
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
    rows = [*_motions(published, decays, simulated), *_stiffnesses(published, pulls, simulated)]
    force = _by_key(published / "forces-3-3.csv", "quantity")
    for floor, fit, made in (("concrete", pulls, simulated), ("carpet", carpet, None)):
        key, thesis = "tire.mu_static", force[f"mu_static_{floor}"]["low"]
        rows.append(_row(f"static friction, {floor}", key, thesis, fit, made))
    inertia = _by_key(published / "inertia-5-1.csv", "element")
    for axis in ("xx", "yy", "zz"):
        rows.append(_row(f"inertia {axis}", f"inertia_kg_m2.{axis}", inertia[axis]["cad_kg_m2"], decays, None))
    damping = _by_key(published / "damping-6-5.csv", "quantity")
    for axis in "xyz":
        thesis = damping[f"damping_{axis}"]["value"]
        rows.append(_row(f"tire damping {axis}", f"tire.damping_{axis}_N_s_m", thesis, decays, simulated))
    return DemoTable((*rows, _row("mass", "mass_kg", "not printed", decays, None)))


def _row(quantity: str, key: str, thesis: str, fit: SessionFit, simulated: SessionFit | None) -> DemoRow:
    estimate = fit.parameters[key]
    made = None if simulated is None else float(simulated.parameters[key].value)
    return DemoRow(quantity, estimate.unit, thesis, float(estimate.value), estimate.std, made)


def _motions(published: Path, decays: SessionFit, simulated: SessionFit) -> list[DemoRow]:
    """(5.9): natural frequency and damping ratio, mean and spread over the trials."""
    motions = _by_key(published / "modes-5-9.csv", "motion")
    rows = []
    for motion in ("roll", "pitch", "yaw"):
        own = [r for r in decays.results.values() if r.get("motion") == motion]
        made = [r for r in simulated.results.values() if r.get("motion") == motion]
        for key, name, si in (("omega_n_rad_s", "natural frequency", "rad/s"), ("xi", "damping ratio", "1")):
            mean, std = _mean([r[key] for r in own])
            again = _mean([r[key] for r in made])[0]
            rows.append(DemoRow(f"{motion}: {name}", si, motions[motion][key], mean, std, again))
    return rows


def _stiffnesses(published: Path, pulls: SessionFit, simulated: SessionFit) -> list[DemoRow]:
    force = _by_key(published / "forces-3-3.csv", "quantity")
    rows = [
        _row(
            f"tire stiffness {axis}",
            f"tire.stiffness_{axis}_N_m",
            force[f"tire_stiffness_{axis}"]["low"],
            pulls,
            simulated,
        )
        for axis in "yz"
    ]
    return [*rows, _belt(force["belt_stiffness"]["low"], pulls, simulated)]


def _belt(printed: str, pulls: SessionFit, simulated: SessionFit) -> DemoRow:
    """(3.8): the first rise of a lengthwise pull with the stiff cable is twice a belt's stiffness."""

    def rises(fit: SessionFit) -> list[float]:
        chosen = [r for file, r in fit.results.items() if r.get("direction") == "longitudinal" and "rope" not in file]
        return [0.5 * r["first_rise_N_m"] for r in chosen if r["load_N"] > 250.0]

    mean, std = _mean(rises(pulls))
    return DemoRow("belt, eq (3.8)", "N/m", printed, mean, std, _mean(rises(simulated))[0])


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
