"""Names, order and metadata decide nothing: the same recordings shuffled and renamed get the same answer, to the last
digit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bank import draw

from ssmr_ident.core.recording import Provenance
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.workflows.diagnose import diagnose

pytestmark = pytest.mark.slow

LIES = ("free_play", "null", "dry-friction-heavy", "nothing-missing", "sensor_saturation", "zz", "a", "hysteresis-loop")


def disguised(campaign: Campaign, seed: int) -> tuple[Campaign, dict[str, str]]:
    """Recordings in another order, under names that lie; and which new name stands for which."""
    order = np.random.default_rng(seed).permutation(len(campaign.measurements))
    names, measurements = {}, []
    for position, index in enumerate(order):
        old = campaign.measurements[index]
        file = f"{LIES[position % len(LIES)]}-{position}.csv"
        names[file] = old.entry.file
        entry = replace(old.entry, file=file, trial=None if old.entry.trial is None else position)
        provenance = Provenance(file, "0" * 64, "csv", "elsewhere")
        recording = replace(old.recording, provenance=provenance, header={"operator": "motor_belt"})
        measurements.append(replace(old, entry=entry, recording=recording))
    session = replace(campaign.session, name="stribeck-and-free-play", entries=tuple(m.entry for m in measurements))
    parameters = replace(campaign.parameters, name="hysteresis", file="hysteresis.yaml")
    return replace(campaign, session=session, measurements=tuple(measurements), parameters=parameters), names


def same(one: Diagnosis, other: Diagnosis, names: dict[str, str]) -> None:
    assert one.verdict == other.verdict
    assert [e.id for e in one.effects] == [e.id for e in other.effects]
    for mine, theirs in zip(one.effects, other.effects, strict=True):
        assert set(mine.indistinguishable_from) == set(theirs.indistinguishable_from)
        assert {n: (e.value, e.std) for n, e in mine.parameters.items()} == {
            n: (e.value, e.std) for n, e in theirs.parameters.items()
        }
    assert (one.heldout.before, one.heldout.after) == (other.heldout.before, other.heldout.after)
    assert list(one.heldout.recordings) == [names[file] for file in other.heldout.recordings]


@pytest.mark.parametrize(("family", "effect"), [("forced", "nonlinear_stiffness"), ("rig_decay", "dry_friction")])
def test_shuffled_and_renamed_recordings_get_the_same_answer(family: str, effect: str) -> None:
    campaign = draw(family, "one", 31, effect, 0.8, short=True).campaign
    plain = diagnose(campaign)
    assert effect in [e.id for e in plain.effects], plain
    hidden, names = disguised(campaign, 1)
    same(plain, diagnose(hidden), names)


def test_a_null_stays_a_null_under_names_that_lie() -> None:
    campaign = draw("forced", "none", 32, short=True).campaign
    hidden, names = disguised(campaign, 2)
    same(diagnose(campaign), diagnose(hidden), names)


def test_recordings_kept_back_by_the_tool_do_not_depend_on_their_order() -> None:
    campaign = draw("rig_decay", "one", 33, "dry_friction", 0.9, short=True).campaign
    targets = tuple(m for m in campaign.measurements if m.entry.role == "target")
    session = replace(campaign.session, entries=tuple(m.entry for m in targets))
    campaign = replace(campaign, session=session, measurements=targets)
    hidden, names = disguised(campaign, 3)
    same(diagnose(campaign), diagnose(hidden), names)
