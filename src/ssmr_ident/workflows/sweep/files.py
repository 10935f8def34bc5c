"""What ``ident sweep`` leaves in its folder beside the runs: sweep.csv and three figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ssmr_ident.report import style
from ssmr_ident.report.figures_sweep import CHANNELS, SweptRun, amplitudes_figure, peaks_figure, spectra_figure
from ssmr_ident.signals.peaks import COUNT
from ssmr_ident.workflows.spectrum.table import write_rows
from ssmr_ident.workflows.sweep.run import Sweep


def write(found: Sweep, output: Path, format: str = "png", figures: bool = True) -> list[Path]:
    """Write the table, and the figures where the runs' rate shows vibrations.

    Parameters
    ----------
    found : Sweep
    output : Path
    format : {"png", "svg", "pdf"}
    figures : bool
    """
    files = [write_rows(output / "sweep.csv", found.rows)]
    if not figures or not all(found.spectra):
        return files
    runs, label = drawn_runs(found), found.axes[0].label
    return [
        *files,
        style.save(spectra_figure(runs, label), output / "spectra", format),
        style.save(peaks_figure(runs, label), output / "peaks", format),
        style.save(amplitudes_figure(runs, label), output / "amplitudes", format),
    ]


def drawn_runs(found: Sweep) -> list[SweptRun]:
    """Runs as figures take them: over the first axis, in groups of the others."""
    first, *others = found.axes
    runs = []
    for row, spectrum in zip(found.rows, found.spectra, strict=True):
        peaks = {
            unit: np.array(
                [[row[f"{axis}_peak_{k + 1}_{unit}"] for k in range(COUNT)] for axis in CHANNELS], dtype=float
            )
            for unit in ("hz", "m_s2")
        }
        runs.append(
            SweptRun(
                row[first.name],
                ", ".join(f"{axis.name} {_short(row[axis.name])}" for axis in others),
                peaks["hz"],
                peaks["m_s2"],
                np.array([row[f"{axis}_amplitude_m_s2"] for axis in CHANNELS]),
                np.array(spectrum["frequency"]),
                np.array([spectrum[axis] for axis in CHANNELS]),
            )
        )
    return runs


def _short(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
