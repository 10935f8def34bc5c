"""How far a campaign is from what its parameters say, recording by recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.campaign import Campaign
from ssmr_ident.compare.prediction import Prediction, predict
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.signals.metrics import log_psd_db, nrmse_percent


@dataclass(frozen=True, eq=False)
class RecordingComparison:
    """One recording: metric over all channels together, and channel by channel."""

    file: str
    experiment: str
    metric: str
    value: float
    channels: Mapping[str, float]
    prediction: Prediction


@dataclass(frozen=True, eq=False)
class Comparison:
    """A campaign against its simulation.

    ``overall`` holds the mean of each metric over its recordings.
    """

    session: str
    params: str
    recordings: tuple[RecordingComparison, ...]

    @property
    def overall(self) -> dict[str, float]:
        metrics = dict.fromkeys(r.metric for r in self.recordings)
        return {m: float(np.mean([r.value for r in self.recordings if r.metric == m])) for m in metrics}

    def as_dict(self) -> dict[str, Any]:
        """The contract's ``ident compare --json``."""
        rows = [
            {"file": r.file, "experiment": r.experiment, "metric": r.metric, "value": r.value,
             "channels": dict(r.channels)}
            for r in self.recordings
        ]  # fmt: skip
        return {"session": self.session, "params": self.params, "recordings": rows, "overall": self.overall}

    def __str__(self) -> str:
        lines = [f"{self.session} against {self.params}"]
        for r in self.recordings:
            channels = "  ".join(f"{name} {value:.3g}" for name, value in r.channels.items())
            lines.append(f"  {r.file:<36} {r.experiment:<20} {r.value:8.3g} {_UNIT[r.metric]}  {channels}")
        lines += [f"  mean {metric}: {value:.3g} {_UNIT[metric]}" for metric, value in self.overall.items()]
        return "\n".join(lines)


_UNIT = {"nrmse_percent": "%", "log_psd_db": "dB"}


def compare(
    campaign: Campaign, parameters: ParameterSet, progress: Callable[[int, int], None] | None = None
) -> Comparison:
    """Simulate every recording of a campaign and measure the distance.

    Parameters
    ----------
    campaign : Campaign
    parameters : ParameterSet
    progress : callable, optional
        Called with the number of recordings done and their total.
    """
    results = []
    for index, measurement in enumerate(campaign.measurements):
        prediction = predict(campaign, measurement, parameters)
        value, channels = measure(prediction)
        entry = measurement.entry
        results.append(
            RecordingComparison(measurement.name, entry.experiment, prediction.metric, value, channels, prediction)
        )
        if progress:
            progress(index + 1, len(campaign.measurements))
    return Comparison(campaign.session.name, parameters.file or parameters.name, tuple(results))


def measure(prediction: Prediction) -> tuple[float, dict[str, float]]:
    """The contract's metric: over all channels together, and of each."""
    measured, simulated, rate = prediction.measured, prediction.simulated, prediction.sample_rate
    if prediction.metric == "log_psd_db":
        channels = np.atleast_1d(log_psd_db(measured, simulated, rate))
        # the mean of squares over channels, as over frequencies
        return float(np.sqrt(np.mean(channels**2))), dict(zip(prediction.names, map(float, channels), strict=True))
    low_pass_hz = prediction.low_pass_hz

    def distance(columns: slice | int) -> float:
        return nrmse_percent(measured[:, columns], simulated[:, columns], rate, low_pass_hz=low_pass_hz)

    scale = 1.0 if len(set(prediction.units)) == 1 else measured.std(axis=0)
    total = nrmse_percent(measured / scale, simulated / scale, rate, low_pass_hz=low_pass_hz)
    return total, {name: distance(index) for index, name in enumerate(prediction.names)}
