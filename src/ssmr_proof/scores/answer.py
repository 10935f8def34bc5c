"""What a diagnosis claims, read from the files that it wrote and from nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml


@dataclass(frozen=True)
class Claim:
    """One named effect with what fits as well.

    Parameters
    ----------
    id : str
    ties : tuple of str
    parameters : mapping of str to (value, std or None)
    sentence : str
    """

    id: str
    ties: tuple[str, ...]
    parameters: Mapping[str, tuple[float, float | None]]
    sentence: str = ""

    @property
    def ids(self) -> tuple[str, ...]:
        return (self.id, *self.ties)


@dataclass(frozen=True)
class Answer:
    """A diagnosis.yaml; ``verdict`` is ``failed`` where there is none.

    Parameters
    ----------
    verdict : str
    claims : tuple of Claim
    heldout : mapping
        The diagnosis' own before, after and noise floor [%].
    located : str
        Its first place in words.
    summary : str
    folder : Path
        With before.yaml and after.yaml.
    session : str
        Which it diagnosed.
    """

    verdict: str
    claims: tuple[Claim, ...]
    heldout: Mapping[str, float] = field(default_factory=dict)
    located: str = ""
    summary: str = ""
    folder: Path = Path()
    session: str = ""

    @property
    def says_missing(self) -> bool:
        """Undetermined says so too: something is missing that the data cannot tell apart."""
        return self.verdict in ("missing_physics", "undetermined")


def read_answer(folder: Path) -> Answer:
    """The answer in a folder that a diagnosis wrote."""
    path = folder / "diagnosis.yaml"
    if not path.is_file():
        return Answer("failed", (), folder=folder)
    with path.open(encoding="utf-8") as stream:
        content = yaml.safe_load(stream)
    claims = tuple(
        Claim(
            str(effect["id"]),
            tuple(effect.get("indistinguishable_from") or ()),
            {name: (float(p["value"]), p.get("std")) for name, p in (effect.get("parameters") or {}).items()},
            str(effect.get("sentence", "")),
        )
        for effect in content.get("effects") or ()
    )
    heldout = {
        k: float(v) for k, v in (content.get("fit", {}).get("heldout") or {}).items() if isinstance(v, int | float)
    }
    return Answer(
        str(content["verdict"]),
        claims,
        heldout,
        _place(content),
        str(content.get("summary", "")),
        folder,
        str(content.get("session", "")),
    )


def _place(content: Mapping[str, Any]) -> str:
    places = content.get("located") or ()
    if not places:
        return ""
    place = places[0]
    if place.get("sentence"):
        return str(place["sentence"])
    return f"{place['recording']}, {place['channel']}, {place['time_s']} s, {place['band_hz']} Hz, {place['region']}"
