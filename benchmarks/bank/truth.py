"""The answer beside a session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ssmr_ident.compare.comparison import measure
from ssmr_ident.compare.outcome import Prediction
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments import Likelihood
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.session import Entry


@dataclass(frozen=True, eq=False)
class Truth:
    """What a session was made with.

    Parameters
    ----------
    verdict : str
    effects : mapping of effect id to its parameters
        In the catalogue's parameters where the plant has the catalogue's formula; empty parameters elsewhere.
    formula : str
        In words, where it is not the catalogue's own.
    parameters : mapping of path to float
        Of the plant without its effects.
    noise_floor : mapping of str to float
        Per recording, what the true signals leave of the metric.
    element : str
        Spring of a network at which the effects act.
    """

    verdict: str
    effects: Mapping[str, Mapping[str, float]]
    formula: str
    parameters: Mapping[str, float]
    noise_floor: Mapping[str, float]
    element: str = ""

    @property
    def ids(self) -> tuple[str, ...]:
        return tuple(sorted(self.effects))


@dataclass(frozen=True, eq=False)
class BankSession:
    """A drawn session; ``size`` is the effect's place between the least (0) and the largest (1) that is drawn."""

    family: str
    kind: str
    seed: int
    size: float
    campaign: Campaign
    truth: Truth


@dataclass(frozen=True, eq=False)
class Made:
    """One recording with its clean channels, before it becomes a measurement."""

    entry: Entry
    recording: Recording
    clean: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def measurement(self) -> Measurement:
        return Measurement(self.entry, self.recording)

    @property
    def noise_floor(self) -> float:
        """The contract's metric between what was logged and what is true, zeros taken off."""
        names = tuple(self.clean)
        logged = np.column_stack([self.recording[name] for name in names])
        true = np.column_stack([self.clean[name] for name in names])
        true = true + (logged - true).mean(axis=0)
        units = tuple(self.recording.channel(name).unit for name in names)
        low_pass = 50.0 if self.measurement.experiment.likelihood is Likelihood.WAVEFORM else None
        return measure(Prediction(self.recording.time, names, units, logged, true, low_pass_hz=low_pass))[0]


def recording(file: str, sample_rate: float, **channels: tuple[np.ndarray, str]) -> Recording:
    """Channels as (samples, unit) on an even time axis from 0."""
    made = tuple(Channel(name, samples, unit, name) for name, (samples, unit) in channels.items())
    n = len(made[0].samples)
    return Recording(np.arange(n) / sample_rate, made, Provenance(file, "", "bank"))


def values_of(parameters: ParameterSet) -> dict[str, float]:
    """The scalars of a parameter set."""
    return {path: float(e.value) for path, e in parameters.items() if np.ndim(e.value) == 0}
