"""Sessions shuffled and renamed, and whether two get the same answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.core.recording import Provenance
from ssmr_ident.diagnose.diagnosis import Diagnosis
from ssmr_ident.experiments.campaign import Campaign

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
