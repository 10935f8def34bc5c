"""Samples that no sensor gives: their squares are no numbers any more, and whatever is made of a log takes squares."""

from __future__ import annotations

import numpy as np

from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.options import RATE
from ssmr_ident.readers.source import Source

FARTHEST = 1e100
"""In SI units: beyond whatever is measured in any of them, and four of them multiplied are below the largest number."""


def refuse_out_of_reach(source: Source, recordings: tuple[Recording, ...]) -> None:
    """Refuse a log with a sample beyond ``FARTHEST``, or with stamps that no clock gives.

    Raises
    ------
    InputError
        Names the channel, when it is read, and what stands there.
    """
    for recording in recordings:
        step = float(np.median(np.diff(recording.time)))
        if not 1.0 / RATE.most <= step <= 1.0 / RATE.least:
            raise source.error(
                f"has samples {step:.3g} s apart, which no clock tells; expected {1.0 / RATE.most:g} to "
                f"{1.0 / RATE.least:g} s",
                "Say which column the time is by --columns time=… and its unit by --time-unit, or give --fs",
            )
        for channel in recording.channels:
            beyond = np.abs(channel.samples) > FARTHEST
            if beyond.any():
                first = int(np.argmax(beyond))
                raise source.error(
                    f"{channel.label or channel.name} is {channel.samples[first]:g} {channel.unit} at "
                    f"{recording.time[first]:.6g} s, beyond anything that is measured",
                    "Mend this value, or leave it empty and read with --on-bad nan",
                )
