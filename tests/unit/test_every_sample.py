"""What goes to every sample, by tables written by hand: no simulation."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from ssmr_ident.doctor.every_sample import _scaled, decisive
from ssmr_ident.doctor.table import Row

SHARE, SAMPLES = 0.25, 20_000.0


def row(ids: str, kinds: str, cost: float, generic: bool = False, dof: float = 3.0, promised: float = 0.0) -> Row:
    fit = cast(Any, SimpleNamespace(cost=cost, dof=dof, promised=promised))
    name = (ids or "baseline") + (" in any shape" if generic else "")
    evidence = 0.5 * (50_000.0 - cost) - 0.5 * dof * math.log(5000.0)
    return Row(tuple(ids.split()), tuple(kinds.split()), name, generic, evidence, cost, 5000.0, fit=fit)


BASE = row("", "", 50_000.0)
LAW = row("free_play", "static_force", 5100.0)
SHAPE = row("unlisted", "static_force", 5090.0, generic=True, dof=20.0)
FAR = row("unlisted", "changing", 40_000.0, generic=True)


def kept(*rows: Row) -> set[str]:
    return {r.name for r in decisive(sorted(rows, key=lambda r: -r.log_evidence), SHARE, SAMPLES)}


def test_what_a_share_rules_out_is_not_asked_again_on_every_sample() -> None:
    second = row("free_play hysteresis", "static_force memory", 5095.0, dof=5.0)  # by as much as noise moves it
    assert kept(BASE, LAW, SHAPE, FAR, second) == {"baseline", "free_play", "unlisted in any shape"}
    may_still = row("hysteresis", "memory", 5150.0, promised=30.0)
    assert "hysteresis" in kept(BASE, LAW, SHAPE, FAR, may_still)


def test_a_pair_that_may_stand_comes_with_what_it_is_held_against() -> None:
    pair = row("free_play hysteresis", "static_force memory", 4400.0, dof=5.0)
    beside = row("free_play unlisted", "static_force static_force", 5000.0, generic=True, dof=9.0)
    other = row("quadratic_damping unlisted", "static_force changing", 9000.0, generic=True, dof=9.0)
    found = kept(BASE, LAW, SHAPE, FAR, pair, beside, other)
    assert {pair.name, beside.name, "free_play"} <= found
    assert other.name not in found


def test_what_is_left_behind_lies_between_the_baseline_and_the_best_as_before() -> None:
    now = (replace(LAW, log_evidence=88_000.0, chi2=20_000.0), replace(BASE, log_evidence=0.0, chi2=196_000.0))
    (far,) = _scaled([FAR], [LAW, SHAPE, FAR, BASE], now)
    part = (FAR.chi2 - LAW.chi2) / (BASE.chi2 - LAW.chi2)
    assert far.chi2 == pytest.approx(20_000.0 + part * 176_000.0)
    assert 0.0 < far.log_evidence < 88_000.0


def test_what_a_line_promises_counts_for_a_row_and_not_against_others() -> None:
    pair = row("free_play hysteresis", "static_force memory", 4400.0, dof=5.0)
    burst = row("quadratic_damping hysteresis", "static_force memory", 30_000.0, dof=5.0, promised=29_000.0)
    better = row("unlisted", "changing", 4000.0, generic=True, dof=20.0)
    assert pair.name in kept(BASE, LAW, SHAPE, better, pair, burst)
