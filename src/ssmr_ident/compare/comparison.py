"""How far a campaign is from what its parameters say, recording by recording."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ssmr_ident.compare.prediction import Prediction, predict
from ssmr_ident.core.frame import frame
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.shown import Shown, html_table
from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.signals.filters import ORDER, low_pass
from ssmr_ident.signals.metrics import log_psd_db, nrmse_percent
from ssmr_ident.signals.noise.hum import MAINS_HZ, mains_line, shows_mains

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class RecordingComparison(Shown):
    """One recording: metric over all channels together, and channel by channel."""

    file: str
    experiment: str
    metric: str
    value: float
    channels: Mapping[str, float]
    prediction: Prediction

    def __str__(self) -> str:
        channels = "  ".join(f"{name} {value:.3g}" for name, value in self.channels.items())
        return f"{self.file:<36} {self.experiment:<20} {self.value:8.3g} {_UNIT[self.metric]}  {channels}"


@dataclass(frozen=True, eq=False)
class Comparison(Shown):
    """A campaign against its simulation.

    ``overall`` holds the mean of each metric over its recordings.
    """

    session: str
    params: str
    recordings: tuple[RecordingComparison, ...]

    def __getitem__(self, file: str) -> RecordingComparison:
        return next(recording for recording in self.recordings if recording.file == file)

    def _repr_html_(self) -> str:
        rows = [
            (r.file, r.experiment, f"{r.value:.3g} {_UNIT[r.metric]}", f"{name} {value:.3g}")
            for r in self.recordings
            for name, value in [max(r.channels.items(), key=lambda item: item[1])]
        ]
        means = [f"mean {metric}: {value:.3g} {_UNIT[metric]}" for metric, value in self.overall.items()]
        header = ("recording", "experiment", "apart by", "worst channel")
        return html_table(header, rows, f"{self.session} against {self.params}", means)

    @property
    def overall(self) -> dict[str, float]:
        metrics = dict.fromkeys(r.metric for r in self.recordings)
        return {m: float(np.mean([r.value for r in self.recordings if r.metric == m])) for m in metrics}

    def to_frame(self) -> pd.DataFrame:
        """A row a channel of a recording: ``file``, ``experiment``, ``metric``, ``channel``, ``value``.

        ``together`` is the value of all channels of the recording.
        """
        rows = [
            {"file": r.file, "experiment": r.experiment, "metric": r.metric, "channel": name, "value": value,
             "together": r.value}
            for r in self.recordings
            for name, value in r.channels.items()
        ]  # fmt: skip
        columns = ("file", "experiment", "metric", "channel", "value", "together")
        return frame(rows, columns, session=self.session, params=self.params)

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
        lines += [f"  {recording}" for recording in self.recordings]
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
    if prediction.high_pass_hz > 0.0:
        measured, simulated = (prediction.judged(c) for c in (measured, simulated))
    elif prediction.low_pass_hz is not None:
        measured, simulated = (_below(c, rate, prediction.low_pass_hz) for c in (measured, simulated))

    def distance(columns: slice | int) -> float:
        return nrmse_percent(measured[:, columns], simulated[:, columns], rate, low_pass_hz=None)

    scale = 1.0 if len(set(prediction.units)) == 1 else measured.std(axis=0)
    total = nrmse_percent(measured / scale, simulated / scale, rate, low_pass_hz=None)
    return total, {name: distance(index) for index, name in enumerate(prediction.names)}


def _below(samples: np.ndarray, sample_rate: float, low_pass_hz: float) -> np.ndarray:
    """Low-passed channels, (n, c), with the mains line filtered as if the record had no ends.

    A zero-phase filter leaves the ends of a record as they are; a hum of several times the motion would count there
    unfiltered. The line is taken off by least squares, and added again with the filter's gain at its frequency; not
    of a stretch with fewer than four of its periods. One shorter than a period of the cut-off is compared as it is.
    """
    if len(samples) * low_pass_hz < sample_rate:
        return samples
    if not shows_mains(len(samples), sample_rate):
        return low_pass(samples, sample_rate, low_pass_hz)
    lines = [mains_line(channel, sample_rate).samples(len(channel), sample_rate) for channel in samples.T]
    hum = np.column_stack(lines)
    gain = 1.0 / (1.0 + (MAINS_HZ / low_pass_hz) ** (2 * ORDER))  # Butterworth, forward and backward
    return low_pass(samples - hum, sample_rate, low_pass_hz) + gain * hum
