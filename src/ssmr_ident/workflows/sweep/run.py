"""Every point of a grid simulated, logged and measured, on all cores; what is there already is not done again."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ssmr_ident import __version__
from ssmr_ident.compare.turning import turning_robot
from ssmr_ident.core.atomic import make_folder, write_text
from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Channel, Recording
from ssmr_ident.core.shown import Shown
from ssmr_ident.core.threads import processors
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.physics.slots import effect_values
from ssmr_ident.readers import writers
from ssmr_ident.session import read_parameters
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.simulate.slips import wheel_slips
from ssmr_ident.workflows.simulate.request import Request, asked_for, check
from ssmr_ident.workflows.simulate.robot import run_robot
from ssmr_ident.workflows.sweep.axes import Axis, Value
from ssmr_ident.workflows.sweep.measured import measured
from ssmr_ident.workflows.sweep.processes import side_by_side

_FIRST = {"robot": 0, "floor": 1}
"""A robot's file brings its own numbers, and a floor its own friction: what changes single numbers comes after."""


@dataclass(frozen=True)
class Point:
    """One run of a sweep.

    Parameters
    ----------
    name : str
        Of its files, without ending.
    values : tuple of float or str
        Of the axes, in their order.
    repeat : int
    parameters : ParameterSet
    request : Request
    laws : tuple of path
        Python files with effects beyond the catalogue.
    """

    name: str
    values: tuple[Value, ...]
    repeat: int
    parameters: ParameterSet
    request: Request
    laws: tuple[Path, ...] = ()

    @property
    def digest(self) -> str:
        """Of everything that the run's numbers hang on."""
        asked = self.request
        run = (asked.experiment.name, asked.conditions, asked.duration, asked.rate, self.repeat)
        laws = (hashlib.sha256(law.read_bytes()).hexdigest() for law in self.laws)
        facts = (__version__, parameters_text(self.parameters), repr(run), *laws)
        return hashlib.sha256("\n".join(facts).encode()).hexdigest()


@dataclass(frozen=True, eq=False)
class Sweep(Shown):
    """A whole sweep.

    Parameters
    ----------
    axes : tuple of Axis
    rows : tuple of mapping
        One per run: its file, the swept values, and what ``measured`` found, with units in the keys.
    spectra : tuple of mapping
        Per run: ``frequency`` [Hz], and amplitude [m/s^2] of ``ax``, ``ay``, ``az``.
    reused : int
        Runs that were there.
    """

    axes: tuple[Axis, ...]
    rows: tuple[dict[str, Any], ...]
    spectra: tuple[dict[str, list[float]], ...]
    reused: int

    def __str__(self) -> str:
        shown = [axis.name for axis in self.axes]
        shown += [f"{axis}_{what}" for axis in ("ax", "ay", "az") for what in ("amplitude_m_s2", "peak_1_hz")]
        shown = [name for name in shown if name in self.rows[0]]
        cells = [shown, *([_cell(row[name]) for name in shown] for row in self.rows[:40])]
        widths = [max(len(row[k]) for row in cells) for k in range(len(shown))]
        lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in cells]
        if len(self.rows) > 40:
            lines.append(f"and {len(self.rows) - 40} more in sweep.csv")
        return "\n".join(lines)


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else "–" if value is None else str(value)


def points_of(
    params: str, axes: Sequence[Axis], request: Request, repeats: int = 1, laws: Sequence[Path] = ()
) -> tuple[Point, ...]:
    """The grid, last axis fastest.

    Raises
    ------
    InputError
        An experiment that is not the whole robot's, a value that does not fit it, a quantity that is swept twice.
    """
    if request.experiment.scenario is None:
        whole = ", ".join(kind.name for kind in EXPERIMENTS.values() if kind.scenario)
        raise InputError("--experiment", f"{request.experiment.name} is not done with a whole robot", f"Give {whole}")
    if not axes:
        raise InputError("--over", "is missing", "Name what is swept, such as --over lambda_max=0.2:1:9")
    targets = [axis.target for axis in axes]
    for target in targets:
        if targets.count(target) > 1:
            raise InputError("--over", f"sweeps {target} twice", "Give all its values in one --over")
    if repeats < 1:
        raise InputError("--repeats", f"is {repeats}, expected 1 or more")
    points: list[Point] = []
    for values in itertools.product(*(axis.values for axis in axes)):
        pairs = sorted(zip(axes, values, strict=True), key=lambda pair: _FIRST.get(pair[0].target, 2))
        file = str(pairs[0][1]) if pairs[0][0].target == "robot" else params
        parameters, own = asked_for(read_parameters(file), request), request
        for axis, value in pairs if file is params else pairs[1:]:
            parameters, own = axis.applied(value, parameters, own)
        check(own)
        robot_from_parameters(parameters)
        effect_values(parameters)
        words = "-".join(f"{axis.name}={_short(value)}" for axis, value in zip(axes, values, strict=True))
        for repeat in range(repeats):
            name = f"{len(points):03d}-{words}" + (f"-{repeat + 1}" if repeats > 1 else "")
            points.append(Point(name, values, repeat, parameters, own, tuple(laws)))
    return tuple(points)


def _short(value: Value) -> str:
    """As it goes into a file's name."""
    return Path(value).stem if isinstance(value, str) else f"{value:g}"


def sweep(
    axes: Sequence[Axis],
    points: Sequence[Point],
    output: Path,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Run what is not there yet.

    Parameters
    ----------
    axes : sequence of Axis
    points : sequence of Point
    output : Path
        Logs go to ``runs/`` in it: one .csv with all channels per run, and one .json with what was measured.
    workers : int, optional
        Processes; by default one per processor.
    progress : callable, optional
        Called with the runs that are done, and all of them.
    """
    folder = make_folder(output / "runs")
    tell = progress or (lambda done, total: None)
    kept = {point.name: _kept(folder, point) for point in points}
    todo = [point for point in points if kept[point.name] is None]
    done = len(points) - len(todo)
    tell(done, len(points))
    # the first one by itself: it compiles the simulator where that has not been done, which every process would do
    first, rest = todo[:1], todo[1:]
    for point in first:
        kept[point.name] = run_point(folder, point)
        done += 1
        tell(done, len(points))
    count = min(workers or processors(), len(rest))
    if count > 1:
        with side_by_side(count, rest[0].laws) as submit:
            waiting = {submit(run_point, folder, point): point for point in rest}
            for future in as_completed(waiting):
                kept[waiting[future].name] = future.result()
                done += 1
                tell(done, len(points))
    else:
        for point in rest:
            kept[point.name] = run_point(folder, point)
            done += 1
            tell(done, len(points))
    found = [kept[point.name] or {} for point in points]
    rows = tuple(
        {"file": f"runs/{point.name}.csv"}
        | dict(zip((axis.name for axis in axes), point.values, strict=True))
        | {"repeat": point.repeat + 1}
        | one["measured"]
        for point, one in zip(points, found, strict=True)
    )
    return Sweep(tuple(axes), rows, tuple(one["spectrum"] for one in found), len(points) - len(todo))


def _kept(folder: Path, point: Point) -> dict[str, Any] | None:
    """What an earlier call measured of the very same run; its log stands before its numbers do."""
    file = folder / f"{point.name}.json"
    if not file.is_file() or not (folder / f"{point.name}.csv").is_file():
        return None
    found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return found if found.get("digest") == point.digest else None


def run_point(folder: Path, point: Point) -> dict[str, Any]:
    """Simulate one point, write its log, measure it, and write that."""
    effects = effect_values(point.parameters)
    robot = (turning_robot if point.request.experiment.on_wheels else robot_from_parameters)(point.parameters)
    run = run_robot(robot, effects, point.request, offset={"y": 1e-7 * point.repeat} if point.repeat else {})
    names = [name for name in run.names if run.scenario.pulled or name not in ("force", "head")]
    slips = wheel_slips(robot, run)
    recording = run.recording(*names)
    channels = [Channel(f"slip_{i + 1}", slips[:, i], "1", f"slip_{i + 1}") for i in range(4)]
    recording = Recording(recording.time, (*recording.channels, *channels), recording.provenance)
    writers.write_csv(folder / f"{point.name}.csv", recording)
    found, spectrum = measured(recording, point.request)
    result = {"digest": point.digest, "measured": found, "spectrum": spectrum}
    write_text(folder / f"{point.name}.json", json.dumps(result) + "\n")
    return result
