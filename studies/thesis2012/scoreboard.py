"""Each statement of the thesis' sections 2, 3 and 6 against what this tool finds, one row each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ssmr_ident.physics.robot import robot_from_parameters
from ssmr_ident.session import read_parameters
from thesis2012.commands import BY_CONSTRUCTION, COMMANDS
from thesis2012.forces import force_rows
from thesis2012.pulls import pull_rows
from thesis2012.rows import Row, Scoreboard
from thesis2012.signal_analysis import signal_rows
from thesis2012.turning import turning_rows

__all__ = ["Row", "Scoreboard", "thesis_scoreboard"]


def thesis_scoreboard(progress: Callable[[str], None] | None = None) -> Scoreboard:
    """Check every statement that can be checked, on the bundled robots, without a seed or a recording.

    Parameters
    ----------
    progress : callable, optional
        Told in words what comes next.
    """
    tell = progress or (lambda _: None)
    robot, platform = (robot_from_parameters(read_parameters(name)) for name in ("p3at-extended", "p3at-platform"))
    tell("signal analysis")
    rows = signal_rows()
    tell("forces")
    rows += force_rows(robot, platform)
    tell("pulls")
    rows += pull_rows(robot)
    rows += turning_rows(robot, progress)
    return Scoreboard(tuple(_with_command(row) for row in rows))


def _with_command(row: Row) -> Row:
    why = BY_CONSTRUCTION.get(row.key)
    said = f"True by construction: {why}. {row.comment}".rstrip() if why and row.passed else row.comment
    return replace(row, command=COMMANDS[row.key], comment=said)
