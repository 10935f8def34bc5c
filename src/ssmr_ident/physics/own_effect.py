"""Effects from outside the package: a file that its user names on a call, or an entry point of an installed package."""

from __future__ import annotations

import functools
import re
import sys
import traceback
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.whole_file import read_whole
from ssmr_ident.physics.effect import Effect, Site

GROUP = "ssmr_ident.effects"
"""Entry points of an installed package, each an effect: ``charge_amplifier = "my_package.charge_amplifier:EFFECT"``."""

MOST_BYTES = 10 * 2**20

FREE_SITES = (Site.OUTPUT, Site.SENSOR, Site.ROBOT, Site.PULL)
"""Where a law acts as a plain function. All others are compiled into the simulator's loop with the package."""


def effect_of_file(file: str | Path, taken: Collection[str]) -> Effect:
    """The value ``EFFECT`` of a Python file, which is run.

    Parameters
    ----------
    file : path
    taken : collection of str
        Ids that it may not have.

    Raises
    ------
    InputError
        There is no such file, it does not run, it holds no effect, or one that cannot be taken.
    """
    path = Path(file)
    try:
        source = read_whole(path, MOST_BYTES, "Give a Python file with an EFFECT")
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(str(file), f"cannot be read: {reason}", "Give a Python file with an EFFECT") from None
    module = ModuleType(f"{__name__}.{re.sub(r'[^0-9A-Za-z_]', '_', path.stem)}")
    module.__file__ = str(path.absolute())
    sys.modules[module.__name__] = module  # dataclasses look their module up
    try:
        exec(compile(source, module.__file__, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        raise InputError(_place(file, error), f"raises {_one_line(error)}", "Mend the file") from None
    if not hasattr(module, "EFFECT"):
        raise InputError(str(file), "has no EFFECT", "End it with EFFECT = Effect(...)")
    return accepted(module.EFFECT, str(file), taken)


def effects_of_packages(taken: Collection[str]) -> Iterator[Effect]:
    """Effects of the entry points of the group, by name.

    Raises
    ------
    InputError
        One that cannot be loaded or taken; names the package that brings it.
    """
    for point in sorted(entry_points(group=GROUP), key=lambda point: point.name):
        package = f" of {point.dist.name}" if point.dist else ""
        where = f"entry point {point.name}{package}"
        try:
            value = point.load()
        except Exception as error:
            raise InputError(where, f"raises {_one_line(error)}", "Mend or uninstall that package") from None
        yield accepted(value, where, taken)


def accepted(value: object, where: str, taken: Collection[str]) -> Effect:
    """An effect from outside, whose laws say in one line what is wrong with them when they are asked.

    Raises
    ------
    InputError
        No effect, an id that is taken or cannot be written in a parameter file, or a site that is compiled.
    """
    if not isinstance(value, Effect):
        raise InputError(where, f"EFFECT is a {type(value).__name__}, expected an Effect", "EFFECT = Effect(id=…, …)")
    if not isinstance(value.id, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", value.id):
        raise InputError(where, f"the id is {value.id!r}, expected small letters, digits and _", "Such as my_law")
    if value.id in taken:
        raise InputError(where, f"the id {value.id} is taken", "Choose another: ident effects lists them")
    if not value.parameters or not all(isinstance(p, Parameter) for p in value.parameters):
        raise InputError(where, "parameters are no Parameter values", "parameters=(Parameter(name, unit, nominal),)")
    if not value.acts or not all(isinstance(s, Site) and callable(law) for s, law in value.acts.items()):
        raise InputError(where, "acts names no law", "acts={Site.OUTPUT: change}")
    if compiled := [site.name for site in value.acts if site not in FREE_SITES]:
        free = ", ".join(site.name for site in FREE_SITES)
        raise InputError(
            where,
            f"acts at {compiled[0]}, which is compiled into the simulator; a file of one's own acts at {free}",
            "Put it into the package itself: docs/howto/add-effect.md, Where it acts",
        )
    if value.rig and Site.OUTPUT not in value.acts:
        raise InputError(where, "rig=True without a law at OUTPUT, where alone it reaches a rig", "rig=False")
    checked = {site: _CHECKED[site](law, where) for site, law in value.acts.items() if law is not None}
    return replace(value, acts=checked)


def _output(law: Callable[..., Any], where: str) -> Callable[..., Any]:
    """Channels of the same names and lengths, in their order."""

    @functools.wraps(law)
    def change(time: np.ndarray, channels: Mapping[str, np.ndarray], **parameters: float) -> dict[str, np.ndarray]:
        found = _asked(law, where, time, dict(channels), **parameters)
        if not isinstance(found, Mapping) or found.keys() != channels.keys():
            got = ", ".join(map(str, found)) if isinstance(found, Mapping) else type(found).__name__
            raise InputError(where, f"its law gives {got or 'nothing'}, expected {', '.join(channels)}", RETURNS)
        for name, samples in channels.items():
            if np.shape(found[name]) != np.shape(samples):
                shapes = f"{np.shape(found[name])}, expected {np.shape(samples)}"
                raise InputError(where, f"its law gives {name} of the shape {shapes}", RETURNS)
        return {name: np.asarray(found[name], dtype=float) for name in channels}

    return change


RETURNS = "Return all channels: {**channels, name: changed}"


def _robot(law: Callable[..., Any], where: str) -> Callable[..., Any]:
    from ssmr_ident.physics.robot import Robot

    @functools.wraps(law)
    def change(robot: Robot, **parameters: float) -> Robot:
        found = _asked(law, where, robot, **parameters)
        if not isinstance(found, Robot):
            problem = f"its law gives a {type(found).__name__}, expected a Robot"
            raise InputError(where, problem, "Return robot.with_changes(…)")
        return found

    return change


def _pull(law: Callable[..., Any], where: str) -> Callable[..., Any]:
    @functools.wraps(law)
    def change(stiffness: float, **parameters: float) -> float:
        found = _asked(law, where, stiffness, **parameters)
        if not isinstance(found, float | int | np.floating) or not found > 0.0:
            raise InputError(where, f"its law gives {found!r}, expected a stiffness [N/m]", "Return a number over 0")
        return float(found)

    return change


_CHECKED = {Site.OUTPUT: _output, Site.ROBOT: _robot, Site.SENSOR: _robot, Site.PULL: _pull}


def _asked(law: Callable[..., Any], where: str, *arguments: Any, **parameters: float) -> Any:
    try:
        return law(*arguments, **parameters)
    except InputError:
        raise
    except Exception as error:
        raise InputError(_place(where, error), f"its law raises {_one_line(error)}", "Mend the law") from None


def _place(file: str | Path, error: BaseException) -> str:
    """The file and the line in it where an error began, as far as it is known."""
    own = str(Path(file).absolute())
    if isinstance(error, SyntaxError) and error.filename == own:
        return f"{file}:{error.lineno}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == own]
    return f"{file}:{lines[-1]}" if lines else str(file)


def _one_line(error: BaseException) -> str:
    text = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{type(error).__name__}: {' '.join(text.split())}"
