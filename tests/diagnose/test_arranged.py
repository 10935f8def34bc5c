"""Recordings in an order of their own."""

from __future__ import annotations

from dataclasses import replace

from bank import draw

from ssmr_ident.diagnose.arranged import arranged, loudness


def test_recordings_are_put_from_the_quietest_to_the_loudest_however_they_are_listed() -> None:
    campaign = draw("rig_decay", "none", 4, short=True).campaign
    own = arranged(campaign).measurements
    sizes = [loudness(m) for m in own]
    assert sizes == sorted(sizes)
    assert {m.name for m in own} == {m.name for m in campaign.measurements}
    backwards = replace(campaign, measurements=campaign.measurements[::-1])
    assert arranged(backwards).measurements == own


def test_recordings_as_loud_as_each_other_go_by_their_samples_not_by_their_names() -> None:
    campaign = draw("rig_decay", "none", 4, short=True).campaign
    one = campaign.measurements[0]
    mirrored = [replace(c, samples=-c.samples) for c in one.recording.channels]
    other = replace(one, recording=replace(one.recording, channels=tuple(mirrored)))
    assert loudness(one) == loudness(other)
    for first, second in (("a.csv", "b.csv"), ("b.csv", "a.csv")):
        named = [replace(m, entry=replace(m.entry, file=f)) for m, f in zip((one, other), (first, second), strict=True)]
        both = arranged(replace(campaign, measurements=tuple(named))).measurements
        swapped = arranged(replace(campaign, measurements=tuple(named[::-1]))).measurements
        assert both == swapped
        assert both[0].recording is swapped[0].recording
