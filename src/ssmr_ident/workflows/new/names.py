"""What the name of a log suggests about how it was made. A name is a hint to be checked, never proof."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from ssmr_ident.experiments import EXPERIMENTS, FREE_RESPONSE, PULL, STRAIGHT, SWIVEL, Experiment

Named = TypeVar("Named")

FLOORS = ("carpet", "concrete", "tile", "tiles", "wood", "parquet", "asphalt", "gravel", "grass", "vinyl", "rubber")
_OF_WORD = {word: experiment for experiment in EXPERIMENTS.values() for word in experiment.file_words}
_MOTION = {"roll": "roll", "pitch": "pitch", "yaw": "yaw"}
_DIRECTION = {"lateral": "lateral", "lat": "lateral", "sideways": "lateral", "longitudinal": "longitudinal"}
_DIRECTION |= {"long": "longitudinal", "lengthwise": "longitudinal", "forward": "longitudinal"}


@dataclass(frozen=True)
class NameHints:
    """What words and numbers in a name say; None or empty for what they do not."""

    experiment: Experiment | None = None
    motion: str | None = None
    direction: str | None = None
    floor: str | None = None
    frame: str | None = None
    cable: str | None = None
    role: str | None = None
    trial: int | None = None
    speed_m_s: float | None = None
    yaw_rate_deg_s: float | None = None
    wheels: bool = False
    spinning: bool = False
    head_mm_s: float | None = None
    amplitude: str | None = None


_NUMBER = r"(?:^|[^0-9a-z.])v?(\d+(?:[.,p]\d+)?)[-_ ]?"
_HEAD = re.compile(_NUMBER + r"(mm|cm|um)[-_ ]?(?:p|per)?[-_ ]?/?[-_ ]?(s|sec|min)(?![a-z])")
_AMPLITUDE = re.compile(_NUMBER + r"(mm|cm|deg|grad|rad|g|n|kn)(?![a-z0-9])")
_MM = {"mm": 1.0, "cm": 10.0, "um": 1e-3}


def head_speed_in(stem: str) -> float | None:
    """Speed of a machine's head [mm/s] by a number with its unit in a name.

    >>> [head_speed_in(name) for name in ("pull_0.5mms", "drag-30mm_min-2", "v2 20mm-s", "20ms")]
    [0.5, 0.5, 20.0, None]
    """
    found = _HEAD.search(stem.lower())
    if found is None:
        return None
    return _plain(found[1]) * _MM[found[2]] / (60.0 if found[3] == "min" else 1.0)


def amplitude_in(stem: str) -> str | None:
    """A number with a unit of length, angle, force or acceleration in a name, as it stands there.

    >>> amplitude_in("pluck-5mm-2"), amplitude_in("swing_40deg"), amplitude_in("pull_5mms")
    ('5 mm', '40 deg', None)
    """
    found = _AMPLITUDE.search(stem.lower())
    return None if found is None else f"{_plain(found[1]):g} {found[2]}"


def _plain(number: str) -> float:
    return float(number.replace(",", ".").replace("p", "."))


def hints_of(stem: str) -> NameHints:
    """Read a file's name without its ending.

    >>> hints = hints_of("v0-w30-t20-frame-concrete")
    >>> hints.yaw_rate_deg_s, hints.floor, hints.frame, hints.trial
    (30.0, 'concrete', 'frame', None)
    >>> hints_of("pull_lateral_rope_2").direction, hints_of("pull_lateral_rope_2").trial
    ('lateral', 2)
    """
    words = [word for word in re.split(r"[^a-zA-Z0-9.+]+|(?<=[a-zA-Z])(?=\d+$)", stem.lower()) if word]
    last = words[-1] if words else ""
    rate, speed = (re.search(rf"(?:^|[-_ ]){letter}(-?\d+(?:\.\d+)?)(?=[-_ ]|$)", stem) for letter in "wv")
    motion, direction = _first(words, _MOTION), _first(words, _DIRECTION)
    experiment = _first(words, _OF_WORD) or (FREE_RESPONSE if motion else PULL if direction else None)
    if experiment is None and rate is not None:
        experiment = SWIVEL if float(rate[1]) else STRAIGHT
    role = "calibration" if any(word.startswith("calib") for word in words) else None
    if any(word.startswith(("heldout", "holdout")) for word in words):
        role = "heldout"
    return NameHints(
        experiment=experiment,
        motion=motion,
        direction=direction,
        floor=next((word for word in words if word in FLOORS), None),
        frame=next((word for word in words if word in ("frame", "platform")), None),
        cable=next((word for word in words if word in ("rope", "steel")), None),
        role=role,
        trial=int(last) if last.isdigit() and len(last) < 4 else None,
        speed_m_s=float(speed[1]) if speed else None,
        yaw_rate_deg_s=float(rate[1]) if rate else None,
        wheels=any(word in ("wheel", "wheels") for word in words),
        spinning="spinning" in words,
        head_mm_s=head_speed_in(stem),
        amplitude=amplitude_in(stem),
    )


def _first(words: list[str], known: Mapping[str, Named]) -> Named | None:
    return next((known[word] for word in words if word in known), None)
