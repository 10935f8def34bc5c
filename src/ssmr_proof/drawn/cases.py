"""What a case hides, drawn from a seed: nothing, one effect, two, a mimic, one outside the catalogue, a faint one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ssmr_proof.drawn import bodies, mimics, springs, strange
from ssmr_proof.drawn.hidden import Change, Hidden, combined
from ssmr_proof.drawn.springs import SCALES, Draw

KINDS: Mapping[str, float] = {"none": 0.25, "one": 0.39, "two": 0.1, "mimic": 0.1, "outside": 0.1, "faint": 0.06}
FAINTEST = -0.5
"""Strength; the limit is 0."""

FAMILIES: Mapping[str, float] = {"decay": 0.45, "rig": 0.35, "pull": 0.2}

_DECAY, _RIG, _PULL = SCALES["decay"], SCALES["rig"], SCALES["pull"]
ONE: Mapping[str, tuple[Draw, ...]] = {
    "decay": (
        springs.hardening(_DECAY), springs.friction(_DECAY), springs.quadratic(_DECAY), springs.relaxation(_DECAY),
        springs.loops(_DECAY), springs.play(_DECAY, 0.0), bodies.frame, bodies.frame, bodies.askew,
        bodies.slow_sensor, bodies.off_centre, bodies.lifted, bodies.coupled,
    ),
    "rig": (
        springs.hardening(_RIG), springs.friction(_RIG), springs.quadratic(_RIG), springs.relaxation(_RIG),
        springs.loops(_RIG), springs.play(_RIG, 1.0), bodies.slow_rig_sensor, bodies.clipped,
    ),
    "pull": (
        springs.hardening(_PULL), springs.relaxation(_PULL), springs.loops(_PULL), bodies.soft_cable,
        bodies.drifting_cell, bodies.falling_friction, bodies.light_grip, bodies.clipped,
    ),
}  # fmt: skip
TWO: Mapping[str, tuple[tuple[Draw, Draw], ...]] = {
    "decay": (
        (bodies.frame, springs.friction(_DECAY)), (springs.hardening(_DECAY), bodies.askew),
        (springs.friction(_DECAY), bodies.slow_sensor), (bodies.frame, springs.hardening(_DECAY)),
        (bodies.off_centre, springs.quadratic(_DECAY)),
    ),
    "rig": (
        (springs.hardening(_RIG), springs.friction(_RIG)), (springs.friction(_RIG), bodies.slow_rig_sensor),
        (springs.play(_RIG, 1.0), springs.quadratic(_RIG)), (springs.hardening(_RIG), springs.quadratic(_RIG)),
    ),
    "pull": (
        (bodies.soft_cable, bodies.drifting_cell), (springs.hardening(_PULL), bodies.drifting_cell),
        (springs.relaxation(_PULL), bodies.light_grip),
    ),
}  # fmt: skip
MIMIC: Mapping[str, tuple[Draw, ...]] = {
    "decay": (
        mimics.loop_like_friction, mimics.friction_like_loop, mimics.quick_relaxation, mimics.frame_on_the_line,
    ),
    "rig": (mimics.loop_like_friction, mimics.friction_like_loop, mimics.quick_relaxation),
    "pull": (mimics.slow_relaxation, mimics.softening_like_cable, mimics.gain_drift),
}  # fmt: skip
OUTSIDE: Mapping[str, tuple[Draw, ...]] = {
    "decay": (strange.uneven_damper, strange.tire_reach_damper),
    "rig": (
        strange.uneven_damper, strange.rig_reach_damper, strange.root_damper, strange.uneven_spring,
        strange.pulsing_spring, strange.absorber,
    ),
    "pull": (),
}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A case before it is recorded.

    Parameters
    ----------
    seed, number : int
        Give everything else.
    family : str
        ``decay`` or ``pull`` (the robot), ``rig``.
    kind : str
        Of KINDS.
    effects : tuple of Hidden
    trap : str
        What a case without hidden physics tempts with: ``hum``, ``noise``, ``priors``; empty for none.
    """

    seed: int
    number: int
    family: str
    kind: str
    effects: tuple[Hidden, ...]
    trap: str = ""

    @property
    def name(self) -> str:
        """Neutral: says nothing of what is hidden."""
        return f"session-{self.number:03d}"

    @property
    def change(self) -> Change:
        return combined(self.effects)

    @property
    def decoupled(self) -> bool:
        return any(effect.id == "translation_coupling" for effect in self.effects)

    @property
    def random(self) -> np.random.Generator:
        """For the recordings; another stream than the draw's."""
        return np.random.default_rng([self.seed, self.number, 1])


def draw_case(seed: int, number: int) -> Case:
    """The case of a seed and a number."""
    random = np.random.default_rng([seed, number, 0])
    kind = str(random.choice(list(KINDS), p=list(KINDS.values())))
    family = str(random.choice(list(FAMILIES), p=list(FAMILIES.values())))
    if kind == "outside" and not OUTSIDE[family]:
        family = "rig"
    case = Case(seed, number, family, kind, ())
    if kind == "none":
        return replace(case, trap=str(random.choice(["", "hum", "noise", "priors"])))
    if kind == "two":
        pair = TWO[family][random.integers(len(TWO[family]))]
        return replace(case, effects=tuple(draw(random, float(random.uniform(0.4, 1.0))) for draw in pair))
    draws = {"one": ONE, "faint": ONE, "mimic": MIMIC, "outside": OUTSIDE}[kind][family]
    draw = draws[random.integers(len(draws))]
    strength = random.uniform(FAINTEST, 0.0) if kind == "faint" else random.uniform()
    return replace(case, effects=(draw(random, float(strength)),))
