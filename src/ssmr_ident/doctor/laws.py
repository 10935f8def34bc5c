"""Named laws: the formulas of the catalogue's effects, begun by least squares along a path."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ssmr_ident.doctor.table import UNLISTED
from ssmr_ident.estimate.along_kernel import force_along
from ssmr_ident.estimate.coordinate import Coordinate
from ssmr_ident.estimate.generic import MEMORY, STATIC
from ssmr_ident.estimate.motor import drive_of
from ssmr_ident.estimate.node import Member, Node
from ssmr_ident.estimate.regression import driving
from ssmr_ident.estimate.simulated import GEARS
from ssmr_ident.estimate.values import Fit, Problem, Start
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.effects.unlisted import TERMS
from ssmr_ident.physics.slots import effect_vector

Array = np.ndarray

FINER = (0.5, 0.25, 0.12)
"""Steps, in logarithms, by which the best shape of a grid is made better along the path."""

LEAST = 1e-3
"""Of an amplitude's usual size, what a coordinate's unit is at the least: of less data would seem to know nothing."""

SINE = "sine"
"""Of what turns alone."""

SHARES = ("knee_share", "sine_share")
"""Amplitudes that are shares of the spring's stiffness."""

SOFTEST = 0.05
"""Of the stiffness that a fit has, what a regression along its path may make of it at the least."""

HYSTERESIS = "hysteresis"
"""A share of the spring's own stiffness: where there is no spring there is no loop."""

WITHIN = {GEARS: "dry_friction"}
"""Laws that are another one where a share of theirs is 0."""

Shape = Mapping[str, float]
_OnPath = tuple[float, Shape, float, float, Shape]


@dataclass(frozen=True)
class Form:
    """A formula of an effect, by its amplitude and the shapes that are tried along a path.

    Parameters
    ----------
    effect, kind, name : str
    shapes : callable
        ``shapes(x, v, f)``: those that are tried, from the largest deflection, speed and force.
    unit : callable
        ``unit(shape, k, x, v, f)``: the effect's parameters at an amplitude of about one ``f``.
    settle : callable
        ``settle(coefficient, unit, share)``: the same at the amplitude that least squares found; ``share`` : the
        coefficient of what is a share of the spring's stiffness, which least squares finds as well.
    moved : mapping of str to bool
        Parameters that are fitted; True for a logarithm.
    variable : str
        ``x`` or ``v``, of which alone it is a function.
    """

    effect: str
    kind: str
    name: str
    shapes: Callable[[float, float, float], Sequence[Shape]]
    unit: Callable[[Shape, float, float, float, float], Shape]
    settle: Callable[[float, Shape, float], Shape]
    moved: Mapping[str, bool]
    variable: str = ""


def _scaled(*names: str) -> Callable[[float, Shape, float], Shape]:
    return lambda c, unit, share: {**unit, **{n: (share if n in SHARES else c) * unit[n] for n in names}}


def _none(x: float, v: float, f: float) -> Sequence[Shape]:
    return ({},)


def _loop(c: float, unit: Shape, share: float) -> Shape:
    return {**unit, "alpha": float(np.clip(1.0 - share * (1.0 - unit["alpha"]), 0.02, 0.98))}


def _term(term: str, size: Callable[[float, float, float], float], variable: str = "") -> Form:
    def unit(s: Shape, k: float, x: float, v: float, f: float) -> Shape:
        return {term: size(x, v, f)}

    return Form(UNLISTED, STATIC, TERMS[term], _none, unit, _scaled(term), {term: False}, variable)


def _grid(name: str, *shares: float) -> Callable[[float, float, float], Sequence[Shape]]:
    """Shapes by shares of the largest deflection, or of the speed where the parameter is one."""
    return lambda x, v, f: [{name: q * (v if name.endswith("m_s") else x)} for q in shares]


def _travel(x: float, v: float, f: float) -> Sequence[Shape]:
    return [{"element_stiffness_N_m": f / (q * x)} for q in (0.01, 0.04, 0.15)]


FORMS = (
    Form("nonlinear_stiffness", STATIC, "cubic", _none,
         lambda s, k, x, v, f: {"k3_N_m3": f / x**3}, _scaled("k3_N_m3"), {"k3_N_m3": False},
         "x"),
    Form("nonlinear_stiffness", STATIC, "two slopes", _grid("knee_m", 0.2, 0.4, 0.6, 0.8, 0.9),
         lambda s, k, x, v, f: {"knee_share": 1.0, **s}, _scaled("knee_share"), {"knee_share": False, "knee_m": True},
         "x"),
    Form("nonlinear_stiffness", STATIC, "cubic and two slopes",
         _grid("knee_m", 0.3, 0.6, 0.85),
         lambda s, k, x, v, f: {"knee_share": 1.0, "k3_N_m3": 0.3 * k / x**2, **s}, _scaled("knee_share", "k3_N_m3"),
         {"knee_share": False, "knee_m": True, "k3_N_m3": False}, "x"),
    Form("nonlinear_stiffness", STATIC, SINE, _none,
         lambda s, k, x, v, f: {"sine_share": 1.0}, _scaled("sine_share"), {"sine_share": False}, "x"),
    Form("free_play", STATIC, "", _grid("gap_m", 0.05, 0.15, 0.3, 0.5, 0.8, 1.2),
         lambda s, k, x, v, f: {"rounding": 0.1, **s}, lambda c, unit, share: unit, {"gap_m": True, "rounding": True},
         "x"),
    Form("quadratic_damping", STATIC, "", _none, lambda s, k, x, v, f: {"d2_N_s2_m2": f / v**2}, _scaled("d2_N_s2_m2"),
         {"d2_N_s2_m2": False}, "v"),
    Form("dry_friction", STATIC, "tanh", _grid("rounding_m_s", 0.01, 0.03, 0.1, 0.3),
         lambda s, k, x, v, f: {"F_c_N": f, **s}, _scaled("F_c_N"), {"F_c_N": False, "rounding_m_s": True},
         "v"),
    Form(GEARS, STATIC, "tanh", _grid("rounding_m_s", 0.003, 0.01, 0.03, 0.1),
         lambda s, k, x, v, f: {"F_c_N": 0.1 * f, "c": 0.3, **s}, _scaled("F_c_N", "c"),
         {"F_c_N": False, "c": False, "rounding_m_s": True}),
    Form("dry_friction", MEMORY, "Dahl", _travel,
         lambda s, k, x, v, f: {"F_c_N": f, "slider": 0.0, **s}, _scaled("F_c_N", "element_stiffness_N_m"),
         {"F_c_N": False, "element_stiffness_N_m": True}),
    Form("dry_friction", MEMORY, "slider", _travel,
         lambda s, k, x, v, f: {"F_c_N": f, "slider": 1.0, **s}, _scaled("F_c_N", "element_stiffness_N_m"),
         {"F_c_N": False, "element_stiffness_N_m": True}),
    Form(HYSTERESIS, MEMORY, "Bouc-Wen, n = 2", _grid("yield_m", 0.05, 0.15, 0.35, 0.7, 1.2),
         lambda s, k, x, v, f: {"alpha": 0.5, **s}, _loop, {"alpha": False, "yield_m": True}),
    Form(HYSTERESIS, MEMORY, "Bouc-Wen, n = 1", _grid("yield_m", 0.05, 0.15, 0.35, 0.7, 1.2),
         lambda s, k, x, v, f: {"alpha": 0.5, "exponent": 1.0, "shape": 0.0, **s}, _loop,
         {"alpha": False, "yield_m": True, "shape": False}),
    _term("c_abs_v_N_s_m", lambda x, v, f: f / v, "v"),
    Form("unlisted", STATIC, "|s - place|", _grid("place_m", -0.4, 0.0, 0.4),
         lambda s, k, x, v, f: {"c_abs_s_N_m": f / x, **s}, _scaled("c_abs_s_N_m"),
         {"c_abs_s_N_m": False, "place_m": False}, "x"),
    _term("c_s2_N_m2", lambda x, v, f: f / x**2, "x"),
    _term("c_v2_N_s2_m2", lambda x, v, f: f / v**2, "v"),
    _term("c_sv_N_s_m2", lambda x, v, f: f / (x * v)),
    _term("c_s2v_N_s_m3", lambda x, v, f: f / (x**2 * v)),
    _term("c_v3_N_s3_m3", lambda x, v, f: f / v**3, "v"),
    _term("c_s_abs_v_N_s_m2", lambda x, v, f: f / (x * v)),
    _term("c_root_v_N_s05_m05", lambda x, v, f: f / v**0.5, "v"),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Proposal:
    """A node and where to begin it, with what it promises."""

    node: Node
    start: Start
    promise: float


def proposals(
    problem: Problem, found: Fit, paths: Sequence[Array], beside: Sequence[Member] = (), forms: Sequence[Form] = FORMS
) -> list[Proposal]:
    """Forms beside the baseline and given members, begun along the path of a fit that follows the motion.

    The force that moved the mass along the path is regressed on the rig and the form; what is left says what the form
    promises, by the logarithm of the residual's size and Schwarz's price of its parameters. The fit decides, not this.

    Parameters
    ----------
    problem : Problem
    found : Fit
        Whose motion the paths are, with its mass.
    paths : sequence of (n, 3) float
    beside : sequence of Member
        That the node has besides; their coordinates begin as in ``found``.
    forms : sequence of Form
    """
    of_rig = found.node.values(found.point)[: len(found.node.baseline)]
    mass, stiff, motor = float(of_rig[0]), float(of_rig[2]), drive_of(of_rig)
    moving = mass + motor.inertia if motor is not None else mass
    x, v = np.concatenate([p[:, 0] for p in paths]), np.concatenate([p[:, 1] for p in paths])
    reach, fastest = float(np.abs(x).max()), float(np.abs(v).max())
    target, first, drives = [], [0], []
    for piece, path, nuisance in zip(problem.pieces, paths, found.nuisances, strict=True):
        pushed = piece.driven and not piece.based
        zero = float(nuisance[found.node.states]) if pushed else 0.0
        drives.append(driving(piece, path, motor, zero) if pushed else np.zeros(len(path)))
        target.append(drives[-1] - moving * path[:, 2])
        first.append(first[-1] + len(path))
    force = np.concatenate(target)
    size = float(np.sqrt(np.mean(force**2)))
    plain = np.column_stack([x / reach, v / fastest, np.ones(len(x))])
    for law in (m for m in beside if m.law is not None):
        own = CATALOGUE[law.id].begun({**(law.law or {}), **found.node.of(law, found.point)})
        column = law_along(problem, paths, first, drives, law.id, own, stiff)
        plain = np.column_stack([plain, column / max(float(np.sqrt(np.mean(column**2))), 1e-300)])
    result = []
    sizes = reach, fastest, 0.3 * size
    turns = any(unit.startswith("rad") for unit in problem.pieces[0].units)
    geared = turns and any(p.driven and not p.based for p in problem.pieces)
    possible = [f for f in forms if (turns or f.name != SINE) and (stiff > 0.0 or f.effect != HYSTERESIS)]
    possible = [f for f in possible if geared or f.effect != GEARS]
    for form in (f for f in possible if _another(f, beside)):
        along = partial(on_path, form, partial(law_along, problem, paths, first, drives), plain, force, stiff, sizes)
        rest, shape, k, d, values = best_shape(along, form.shapes(*sizes))
        member = member_of(form, values, form.unit(shape, stiff, *sizes), reach)
        node = Node(found.node.baseline, (*beside, member))
        point = _begun(node, found, (mass, max(d, 0.0), k), member, values)
        count = len(force)
        promise = -0.5 * (np.log(max(rest, 1e-300)) + len(form.moved) * np.log(count) / count)
        result.append(Proposal(node, Start(point, paths=tuple(paths)), promise))
    return sorted(result, key=lambda p: -p.promise)


def _another(form: Form, beside: Sequence[Member]) -> bool:
    """Whether a form is another effect than those beside it: a term in no list, over the variable of a law, is that
    law's formula."""
    return not any(
        m.id == form.effect or (form.variable and form.variable == m.variable and UNLISTED in (m.id, form.effect))
        for m in beside
    )


def simpler(node: Node) -> list[Node]:
    """The same with a part of one law's formula dropped, where that is a formula itself, of this law or of one that it
    contains."""
    found = []
    for member in (m for m in node.members if m.law is not None):
        names = {c.name for c in member.coordinates}
        for form in (f for f in FORMS if f.effect in (member.id, WITHIN.get(member.id)) and set(f.moved) < names):
            kept = tuple(c for c in member.coordinates if c.name in form.moved)
            what = Member(form.effect, form.kind, form.name, kept, law={}, variable=form.variable)
            less = replace(what, element=member.element)
            members = tuple(less if m is member else m for m in node.members)
            found.append(replace(node, members=members))
    return found


def best_shape(along: Callable[[Shape], _OnPath], shapes: Sequence[Shape]) -> _OnPath:
    """The best of a grid, and of ever smaller steps about it."""
    best = min((along(shape) for shape in shapes), key=lambda found: found[0])
    for step in FINER:
        factors = (math.exp(step), math.exp(-step))
        near = [{**best[1], name: value * factor} for name, value in best[1].items() for factor in factors]
        best = min((best, *(along(shape) for shape in near)), key=lambda found: found[0])
    return best


def on_path(
    form: Form, along: Callable[[str, Shape, float], Array], plain: Array, force: Array, stiffness: float,
    sizes: tuple[float, float, float], shape: Shape,
) -> _OnPath:  # fmt: skip
    """The force regressed on the rig and a form: what is left, the shape, stiffness, damping, the form's values."""
    unit = CATALOGUE[form.effect].begun(form.unit(shape, stiffness, *sizes))
    column = along(form.effect, unit, stiffness)
    norm = float(np.sqrt(np.mean(column**2)))
    if not np.isfinite(norm) or norm <= 0.0:  # it acts nowhere along this path
        norm, column = 1.0, np.zeros(len(column))
    design = np.column_stack([plain, column / norm])
    coefficients, _, _, _ = np.linalg.lstsq(design, force, rcond=None)
    rest = float(np.sum((force - design @ coefficients) ** 2))
    k, d, c = coefficients[0] / sizes[0], coefficients[1] / sizes[1], coefficients[-1] / norm
    k = max(k, SOFTEST * stiffness)
    share = c * stiffness / k if stiffness > 0.0 else c
    return rest, shape, k, d, form.settle(c, unit, share)


def member_of(form: Form, values: Shape, unit: Shape, reach: float) -> Member:
    """A form with its coordinates about given values; what is next to nothing keeps a share of its usual size."""
    declared = {p.name: p for p in CATALOGUE[form.effect].parameters}
    coordinates = []
    for name, log in form.moved.items():
        p, value = declared[name], values[name]
        scale = max(abs(value), LEAST * abs(unit.get(name, 0.0))) or 1.0
        if name == "place_m":
            scale = reach
        low, high = p.lower, p.upper
        if log:
            low, high = max(low, 1e-3 * scale), min(high, 1e3 * scale)
        coordinates.append(Coordinate(name, scale, log, low, high, 0.0, 3.0 if log else np.inf, p.unit))
    held = {name: value for name, value in values.items() if name not in form.moved}
    return Member(form.effect, form.kind, form.name, tuple(coordinates), law=held, variable=form.variable)


def _begun(node: Node, found: Fit, given: Sequence[float], member: Member, values: Shape) -> Array:
    """A node's coordinates: baseline as given (mass, damping, stiffness), members as a fit or a law has them."""
    old = {id(c): float(p) for c, p in zip(found.node.coordinates, found.point, strict=True)}
    own = {id(c): c.at(values[c.name]) for c in member.coordinates}
    point = np.array([own.get(id(c), old.get(id(c), c.mean)) for c in node.coordinates])
    point[:3] = [c.at(v) for c, v in zip(node.baseline[:3], given, strict=True)]
    return point


def law_along(
    problem: Problem, paths: Sequence[Array], first: Sequence[int], drives: Sequence[Array], effect: str,
    values: Shape, stiffness: float,
) -> Array:  # fmt: skip
    """A law's force along the paths, (n,) float [N]; ``drives`` : what drives along each, none where no gears carry
    it."""
    e = effect_vector({effect: values})
    out = np.empty(first[-1])
    for k, (piece, path, at) in enumerate(zip(problem.pieces, paths, first[:-1], strict=True)):
        drive = drives[k] if drives else np.zeros(len(path))
        asked = effect == UNLISTED, effect == GEARS
        force_along(path, drive, piece.step * piece.every, stiffness, e, *asked, out[at : at + len(path)])
    return out
