"""What stands in a robot's table, by rows written by hand."""

from __future__ import annotations

from typing import cast

from ssmr_ident.doctor.robots.answer import told_apart
from ssmr_ident.doctor.robots.found import Found
from ssmr_ident.doctor.table import Row

BASE, NOISE = 100_000.0, 10_000.0
FITTED = cast("Found", None)


def row(ids: str, kinds: str, chi2: float, generic: bool = False) -> Row:
    names = tuple(ids.split())
    return Row(names, tuple(kinds.split()), ids or "baseline", generic, 0.5 * (BASE - chi2), chi2, NOISE)


def standing(*rows: Row) -> list[Row]:
    return [row for row, _ in told_apart([(row, FITTED) for row in (row("", "", BASE), *rows)])]


def test_what_a_formula_may_leave_is_no_second_effect() -> None:
    """Friction in another formula than the world's leaves 1 % of the misfit, which a mast takes; or 5 %."""
    friction = row("dry_friction", "memory", 11_000.0)
    pair = row("dry_friction flexible_mast", "memory extra_motion", NOISE)
    mast = row("flexible_mast", "extra_motion", 60_000.0)
    assert pair not in standing(friction, mast, pair)
    more = row("dry_friction", "memory", 15_000.0)
    assert pair in standing(more, mast, pair)
    # and friction beside a mast takes its share as well
    assert pair not in standing(more, row("flexible_mast", "extra_motion", 11_000.0), pair)


def test_a_second_effect_beside_any_shape_of_the_first() -> None:
    """Where a shape follows as well as the law, what is left beside that is no formula's: the decision holds them
    against each other."""
    hardening, shape = (
        row("nonlinear_stiffness", "static_force", 11_000.0),
        row("unlisted", "static_force", 10_900.0, generic=True),
    )
    pair, mast = (
        row("nonlinear_stiffness flexible_mast", "static_force extra_motion", NOISE),
        row("flexible_mast", "extra_motion", 60_000.0),
    )
    both = row("flexible_mast unlisted", "extra_motion static_force", 10_500.0, generic=True)
    assert pair in standing(hardening, mast, pair, shape, both)


def test_a_shape_that_a_law_of_its_kind_beats_does_not_hold_it() -> None:
    """Play has corners that smooth terms have not."""
    play, smooth = row("free_play", "static_force", 12_000.0), row("unlisted", "static_force", 30_000.0, generic=True)
    assert smooth not in standing(play, smooth)
    assert smooth in standing(row("free_play", "static_force", 31_000.0), smooth)
    changing = row("unlisted", "changing", 40_000.0, generic=True)
    assert changing in standing(play, smooth, changing)
