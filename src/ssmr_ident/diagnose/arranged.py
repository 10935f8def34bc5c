"""Recordings in an order of their own, so that the order in which a session lists them decides nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ssmr_ident.experiments.campaign import Campaign, Measurement


def arranged(campaign: Campaign) -> Campaign:
    """The campaign with its recordings from the quietest to the loudest.

    Sums over recordings round differently in another order, and where a law is rough (friction that lets go) a descent
    then ends elsewhere: in a rig, at one of two ends 0.29 standard deviations apart.
    """
    return replace(campaign, measurements=tuple(sorted(campaign.measurements, key=_by_data)))


def loudness(measurement: Measurement) -> float:
    """Largest standard deviation of a channel, in the channel's unit."""
    return max(float(np.std(c.samples)) for c in measurement.recording.channels)


def _by_data(measurement: Measurement) -> tuple[float, bytes]:
    channels = sorted(measurement.recording.channels, key=lambda c: c.name)
    return loudness(measurement), b"".join(np.ascontiguousarray(c.samples).tobytes() for c in channels)
