"""What the figures of a diagnosis are drawn from: plain arrays, no drawing."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, eq=False)
class Overlay:
    """One channel of one recording: measured, and simulated before and after.

    Parameters
    ----------
    recording, channel, unit : str
    heldout : bool
        Never fitted.
    time : (n,) float [s]
    measured, before, after : (n,) float
        Low-passed as the metric does; ``after`` equals ``before`` where nothing was added.
    metric : (float, float, float)
        Before, after, noise floor of the whole recording.
    """

    recording: str
    channel: str
    unit: str
    heldout: bool
    time: np.ndarray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    metric: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class ResidualMap:
    """Power of the whitened residual over time and frequency, against what noise alone gives (0 dB).

    Parameters
    ----------
    recording, channel : str
    time : (m,) float [s]
    frequency : (k,) float [Hz]
    before, after : (k, m) float [dB]
    threshold_db : float
        Above it noise alone comes once in 100 maps.
    """

    recording: str
    channel: str
    time: np.ndarray
    frequency: np.ndarray
    before: np.ndarray
    after: np.ndarray
    threshold_db: float


@dataclass(frozen=True, eq=False)
class ForceSurface:
    """Restoring force that the baseline leaves unexplained, over displacement and velocity (Masri and Caughey 1979).

    Parameters
    ----------
    recording, where : str
        ``where`` names the coordinate ("lateral deflection of the tires").
    displacement, velocity : (n,) float
    before, after : (n,) float
        Residual force at these points.
    units : (str, str, str)
        Of displacement, velocity, force.
    """

    recording: str
    where: str
    displacement: np.ndarray
    velocity: np.ndarray
    before: np.ndarray
    after: np.ndarray
    units: tuple[str, str, str] = ("m", "m/s", "N")


@dataclass(frozen=True, eq=False)
class Drift:
    """A baseline parameter refitted in parts of the data, ordered along one axis.

    ``value`` and ``std`` are relative to the whole fit (1 = as in the whole). ``p_value`` is by permutation.
    """

    parameter: str
    along: str
    unit: str
    position: np.ndarray
    value: np.ndarray
    std: np.ndarray
    p_value: float
    reading: str = ""


@dataclass(frozen=True, eq=False)
class SpeedMap:
    """Spectra over speed (waterfall): recorded beside simulated.

    Parameters
    ----------
    channel : str
    speed : (s,) float [rad/s]
        Yaw rates.
    frequency : (k,) float [Hz]
    recorded, before, after : (s, k) float [dB re 1 (m/s^2)^2/Hz]
    lines : tuple of (str, (s,) float [Hz])
        Rates that a line could follow: wheel rate, path speed over a pitch, a fixed frequency.
    names : tuple of str
        What each spectrum is, beside its speed: ``target``, ``held out``; empty where that needs no word.
    """

    channel: str
    speed: np.ndarray
    frequency: np.ndarray
    recorded: np.ndarray
    before: np.ndarray
    after: np.ndarray
    lines: tuple[tuple[str, np.ndarray], ...] = ()
    names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Evidence:
    """All that a report shows."""

    overlays: tuple[Overlay, ...] = ()
    maps: tuple[ResidualMap, ...] = ()
    surfaces: tuple[ForceSurface, ...] = ()
    drifts: tuple[Drift, ...] = ()
    speeds: tuple[SpeedMap, ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)
