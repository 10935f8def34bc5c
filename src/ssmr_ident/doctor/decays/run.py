"""A diagnosis of free decays from their campaign: search, table, decision, answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from threadpoolctl import threadpool_limits

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import arranged
from ssmr_ident.diagnose.assemble import assembled
from ssmr_ident.diagnose.diagnosis import Diagnosis, KindShare
from ssmr_ident.diagnose.engine import Outcome, informed
from ssmr_ident.diagnose.followed import explained
from ssmr_ident.diagnose.setup import Setup, set_up
from ssmr_ident.diagnose.weigh import Explanation
from ssmr_ident.doctor.decays.found import Found, Search
from ssmr_ident.doctor.decays.members import EXTRA, GEOMETRY, KINDS, MEMORY, SENSOR, STATIC
from ssmr_ident.doctor.decays.recordings import decay_of
from ssmr_ident.doctor.decays.search import searched
from ssmr_ident.doctor.decide import MISSING, Decision, decide
from ssmr_ident.doctor.table import Row
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.identify.body.builder import RobotBuilder
from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import differentiate, evaluate

Progress = Callable[[str, int, int], None]

BASELINE = "rigid6"

ELEMENTS = {STATIC: "tire", MEMORY: "tire", EXTRA: "body", GEOMETRY: "body", SENSOR: "sensor.acceleration"}
"""Where members of each kind act: in every tire alike, on the body, on all axes of the accelerometer."""

SHOWN = 2
"""Models that fit alike and are brought to the page at the most."""


def diagnose(
    campaign: Campaign,
    parameters: ParameterSet | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Locate, name and prove what the baseline of a robot's free responses leaves out.

    Parameters
    ----------
    campaign : Campaign
        Of free responses, with ``baseline: rigid6``.
    parameters : ParameterSet, optional
        What is known beforehand, in place of the session's own file.
    seed : int
        Of permutations.
    progress : callable, optional
    """
    for m in campaign.measurements:
        if campaign.session.baseline != BASELINE or not m.experiment.free:
            raise InputError(
                f"{campaign.session.folder / 'session.yaml'}: {m.name}",
                f"this doctor takes free responses of a robot with baseline {BASELINE}; this is a {m.entry.experiment} "
                f"with baseline {campaign.session.baseline}",
                "Ask ident diagnose",
            )
    known = campaign.parameters if parameters is None else parameters
    with threadpool_limits(1, user_api="blas"):
        setup = informed(set_up(arranged(replace(campaign, parameters=known)), known), known)
        builder = RobotBuilder.of(known)
        search = searched([decay_of(t, builder) for t in setup.fitted], setup.model, progress)
        rows = table(search)
        decision = decide([row for row, _ in rows])
        found = assembled(outcome(setup, search, rows, decision), known, seed)
    # what takes any shape is made of several laws' terms, and is none of them
    shown = [e for e in found.effects if decision.listed or e.id == "unlisted"]
    named = tuple(replace(e, kind=KINDS[e.id], element=ELEMENTS[KINDS[e.id]]) for e in shown)
    kinds = tuple(KindShare(s.kind, ELEMENTS[s.kind], float(s.share), float(s.log_evidence)) for s in decision.kinds)
    return replace(found, effects=named, kinds=kinds)


def table(search: Search) -> list[tuple[Row, Found]]:
    """Every model in one unit: log evidence over the baseline, by what the best one leaves."""
    best = search.best
    temper = max(best.chi2 / search.samples, 1.0)
    if best.fit is not None:
        temper *= best.fit.size / best.fit.independent
    samples, base = search.samples / temper, search.baseline

    def row(found: Found) -> Row:
        count = sum(max(sum(c.effect == name for c in found.model.free), 1) for name in found.model.held)
        gain = 0.5 * (base.cost - found.cost) / temper - 0.5 * count * math.log(samples)
        names = tuple(m.id for m in found.members)
        forms = " + ".join(f"{m.id} ({m.form})" for m in found.members) or "baseline"
        generic = any(m.generic for m in found.members)
        kinds = tuple(m.kind for m in found.members)
        return Row(names, kinds, forms, generic, gain, found.chi2 / temper, samples, search.over(found))

    return [(row(found), found) for found in search.all]


def outcome(setup: Setup, search: Search, rows: Sequence[tuple[Row, Found]], decision: Decision) -> Outcome:
    """The decision as the page takes it: the baseline, what is named, and what it cannot be told apart from."""
    base = _shown(setup, search.baseline)
    tried, rivals, chosen = [base], [], base
    if decision.verdict == MISSING and decision.chosen is not None:
        by_name = {row.name: (row, found) for row, found in rows}
        first = by_name[decision.chosen.name][1]
        chosen = _shown(setup, first)
        ties = set(decision.ties)
        own = set(decision.chosen.ids)
        alike = [found for row, found in rows if set(row.ids) - own and set(row.ids) - own <= ties]
        rivals = [_shown(setup, found) for found in alike[:SHOWN]]
        tried += [chosen, *rivals]
    return Outcome(setup, base, tuple(tried), chosen, tuple(rivals), _evidence(rows, tried), ())


def _evidence(rows: Sequence[tuple[Row, Found]], tried: Sequence[Explanation]) -> dict[str, float]:
    best: dict[str, float] = {}
    for row, _ in rows:
        name = "+".join(row.ids) or "baseline"
        best[name] = max(best.get(name, -math.inf), row.log_evidence)
    return {e.id: best.get(e.id, 0.0) for e in tried}


def _shown(setup: Setup, found: Found) -> Explanation:
    """A model at full resolution, and followed on what was kept back."""
    assert found.fit is not None
    fit = descend(evaluate(setup.fitted, found.model, found.point, found.fit.nuisances), 1, plain=True)
    return explained(setup.kept, differentiate(fit))
