"""Figures of a fit: frequency and damping over amplitude, and the saw-tooth of a pull taken apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ssmr_ident.identify.decays.backbone import Backbone
from ssmr_ident.identify.forces.friction import full_teeth
from ssmr_ident.identify.forces.sawtooth import Pull
from ssmr_ident.report import style


@dataclass(frozen=True, eq=False)
class NamedBackbone:
    """Frequency and damping over amplitude of one recording.

    Parameters
    ----------
    name : str
    group : str
        Recordings of one motion share their axes.
    unit : str
        Of the amplitude.
    backbone : Backbone
    """

    name: str
    group: str
    unit: str
    backbone: Backbone


@dataclass(frozen=True, eq=False)
class NamedPull:
    """One pull and what was read from it.

    Parameters
    ----------
    name : str
    position : (n,) float [m]
        While the machine moves.
    force : (n,) float [N]
    pull : Pull
    """

    name: str
    position: np.ndarray
    force: np.ndarray
    pull: Pull


@dataclass(frozen=True, eq=False)
class NamedDecay:
    """One free response as the thesis reads it, and the decay that was fitted to it.

    Parameters
    ----------
    name, motion, unit : str
    time : (n,) float [s]
    samples : (n,) float [unit]
        Low-passed, without offset.
    start, amplitude, rate : float [s], [unit], [1/s]
        A·exp(-lambda·(t - start)) of the motion's own mode.
    peak_hz, resolution_hz : float [Hz]
        Highest line of the FFT, and the distance of its bins.
    """

    name: str
    motion: str
    unit: str
    time: np.ndarray
    samples: np.ndarray
    start: float
    amplitude: float
    rate: float
    peak_hz: float
    resolution_hz: float


@style.house
def envelope_figure(decays: Sequence[NamedDecay]) -> Figure:
    """Each decay of one motion under its envelope ±A·exp(-lambda·t), one below the other."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.75 * len(decays) + 0.8)
    grid = figure.subplots(len(decays), 1, sharex=True, squeeze=False)[:, 0]
    for axes, decay in zip(grid, decays, strict=True):
        axes.plot(decay.time, decay.samples, color=style.MEASURED, lw=0.7)
        after = decay.time[decay.time >= decay.start]
        envelope = decay.amplitude * np.exp(-decay.rate * (after - decay.start))
        for side in (1.0, -1.0):
            axes.plot(after, side * envelope, color=style.ORANGE, lw=0.9)
        axes.set_title(
            f"{decay.name}: {decay.peak_hz:.2f} Hz, A {decay.amplitude:.3g}, λ {decay.rate:.3g} 1/s", loc="left"
        )
    grid[-1].set_xlabel("time [s]")
    figure.supylabel(f"{decays[0].motion}, below 20 Hz [{style.unit_text(decays[0].unit)}]", fontsize=8)
    return figure


@style.house
def backbone_figure(backbones: Sequence[NamedBackbone]) -> Figure:
    """Natural frequency (above) and damping ratio (below) over amplitude, a column per group.

    Bars are standard deviations of each window; windows overlap by half.
    """
    groups = list(dict.fromkeys(b.group for b in backbones))
    width = style.SINGLE_COLUMN if len(groups) == 1 else style.DOUBLE_COLUMN
    figure = style.new_figure(width, 3.6)
    grid = figure.subplots(2, len(groups), sharex="col", squeeze=False)
    for column, group in enumerate(groups):
        members = [b for b in backbones if b.group == group]
        above, below = grid[0, column], grid[1, column]
        for index, member in enumerate(members):
            colour = style.SERIES[index % len(style.SERIES)]
            # past the colours, markers tell recordings apart
            marker = style.MARKERS[index // len(style.SERIES) % len(style.MARKERS)]
            look = {"color": colour, "marker": marker, "ms": 3, "lw": 0.7, "elinewidth": 0.6, "capsize": 1.5}
            line = member.backbone
            hertz = 2 * np.pi
            above.errorbar(line.amplitude, line.omega_n / hertz, line.omega_n_std / hertz, label=member.name, **look)
            below.errorbar(line.amplitude, line.xi, line.xi_std, **look)
        above.set_title(style.name_text(group))
        above.margins(y=0.15)
        below.set_xlabel(f"amplitude [{style.unit_text(members[0].unit)}]")
        if len(members) <= 2 * len(style.SERIES):
            above.legend(fontsize=5 if len(members) > 4 else 6, ncols=1 if len(members) < 5 else 2)
    grid[0, 0].set_ylabel(r"natural frequency $\omega_n/2\pi$ [Hz]")
    grid[1, 0].set_ylabel(r"damping ratio $\xi$ [–]")
    return figure


@style.house
def sawtooth_figure(named: NamedPull) -> Figure:
    """Force over the machine's travel with the first rise, the teeth that count, the small ones, and the level."""
    pull, millimetres = named.pull, 1e3 * (named.position - named.position[0])
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    axes = figure.subplots()
    axes.plot(millimetres, named.force, color=style.RAW, lw=0.6, label="measured", zorder=1)
    first = pull.first
    rise = 1e3 * (np.array([first.x_start, first.x_end]) - named.position[0])
    axes.plot(
        rise, [first.force_start, first.force_end], color=style.BLUE, lw=1.8, zorder=3,
        label=f"first rise {first.slope / 1e3:.4g} ± {first.slope_std / 1e3:.1g} N/mm",
    )  # fmt: skip
    if pull.slides:
        begin = millimetres[min(pull.slides_from, len(millimetres) - 1)]
        axes.hlines(
            pull.level, begin, millimetres[-1], color=style.INK, ls="--", lw=0.8, zorder=2,
            label=f"sliding {pull.level:.4g} ± {pull.level_std:.2g} N",
        )  # fmt: skip
    if pull.stick_slip:
        full = full_teeth(pull)
        small = [tooth for tooth in pull.teeth if tooth not in full]
        for teeth, face, label in ((full, True, "teeth"), (small, False, "small teeth, not counted")):
            if not teeth:
                continue
            at = millimetres[[tooth.sample for tooth in teeth]]
            for values, marker, colour in (
                ([tooth.peak for tooth in teeth], "v", style.ORANGE),
                ([tooth.trough for tooth in teeth], "^", style.GREEN),
            ):
                where = "peaks" if marker == "v" else "troughs"
                axes.plot(
                    at, values, marker, ms=3.5, color=colour, zorder=4, mfc=colour if face else "white", mew=0.6,
                    label=f"{where} of {len(teeth)} {label}",
                )  # fmt: skip
    axes.set_title(style.name_text(named.name), loc="left")
    axes.set_xlabel("travel of the machine [mm]")
    axes.set_ylabel("force [N]")
    axes.margins(x=0.01)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure
