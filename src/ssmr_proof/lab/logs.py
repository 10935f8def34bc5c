"""A recording of the plant beside what it would be without noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ssmr_ident.compare import Prediction
from ssmr_ident.compare.comparison import measure
from ssmr_ident.core.recording import Channel, Provenance, Recording


@dataclass(frozen=True, eq=False)
class Log:
    """One recording of a case.

    Parameters
    ----------
    stem : str
        Of the file's name.
    entry : mapping
        Its line in session.yaml without the file.
    time : (n,) float [s]
    channels : tuple of Channel
        As logged.
    clean, logged : (n, c) float
        The compared quantities in SI, without noise and as the log gives them back.
    names : tuple of str
        Of the compared quantities.
    low_pass_hz : float or None
        Of the metric.
    heldout : bool
    """

    stem: str
    entry: Mapping[str, Any]
    time: np.ndarray
    channels: tuple[Channel, ...]
    clean: np.ndarray
    logged: np.ndarray
    names: tuple[str, ...]
    low_pass_hz: float | None
    heldout: bool

    @property
    def recording(self) -> Recording:
        return Recording(self.time, self.channels, Provenance(self.stem, "", "plant"))

    def noise_floor(self) -> float:
        """The metric between the log and the plant's own motion [%]: what the true model leaves."""
        units = ("",) * len(self.names)
        prediction = Prediction(self.time, self.names, units, self.logged, self.clean, low_pass_hz=self.low_pass_hz)
        return measure(prediction)[0]
