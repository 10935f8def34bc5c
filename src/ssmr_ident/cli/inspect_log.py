"""What ``ident inspect`` says about one recording."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.readers.health import LogHealth, health_of
from ssmr_ident.signals.noise.hum import mains_line


@dataclass(frozen=True)
class LogSummary:
    """A recording with its health and the mains hum of its channels.

    Parameters
    ----------
    hum : dict of str to (float, float)
        Amplitude at the mains frequency and its standard deviation, in the channel's unit; channels of which it
        cannot be told (too short, too slow, missing samples) are left out.
    """

    recording: Recording
    health: LogHealth
    mains_hz: float
    hum: dict[str, tuple[float, float]]

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and words; values that are not finite become None."""
        provenance, health = self.recording.provenance, self.health
        channels = []
        for channel in health.channels:
            facts = {k: _plain(v) for k, v in asdict(channel).items()}
            amplitude, std = self.hum.get(channel.name, (None, None))
            channels.append(facts | {"mains_amplitude": amplitude, "mains_amplitude_std": std})
        return {
            "file": provenance.file,
            "part": provenance.part,
            "reader": provenance.reader,
            "sha256": provenance.sha256,
            "samples": health.samples,
            "start_s": min(channel.start_s for channel in health.channels),
            "duration_s": health.duration,
            "sample_rate_hz": health.sample_rate,
            "jitter_s": health.jitter,
            "gaps": health.gaps,
            "mains_hz": self.mains_hz,
            "channels": channels,
            "header": dict(self.recording.header),
            "notes": [asdict(note) for note in self.recording.notes],
        }


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def summary_of(recording: Recording, mains_hz: float) -> LogSummary:
    """Look over one recording.

    Parameters
    ----------
    recording : Recording
    mains_hz : float [Hz]
    """
    hum = {}
    for channel in recording.channels:
        try:
            logged = recording.series(channel.name)
            line = mains_line(logged.samples, logged.rate, mains_hz)
        except (InputError, np.linalg.LinAlgError):
            continue  # the screen shows a dash: the record cannot tell, which is no fault of the log
        if math.isfinite(line.amplitude) and math.isfinite(line.amplitude_std):
            hum[channel.name] = (line.amplitude, line.amplitude_std)
    return LogSummary(recording, health_of(recording), mains_hz, hum)
