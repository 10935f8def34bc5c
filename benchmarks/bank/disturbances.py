"""What a sensor adds: white and coloured noise, mains, a zero that wanders, a gain that is off, a converter's steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from ssmr_ident.physics.sensor import quantise


@dataclass(frozen=True)
class Disturbance:
    """One sensor's imperfections, the same for all its recordings of a session.

    Parameters
    ----------
    white : float
        Standard deviation per sample of all random noise, in the channel's SI unit.
    coloured : float
        Share of that variance which is first-order coloured noise.
    corner_hz : float [Hz]
        Of the coloured part.
    hum : float
        Amplitude of the 60 Hz line; of its third harmonic a fifth of that.
    wander : float
        Largest excursion of the zero within a recording: a quarter of a slow cosine, of random size and phase.
    quantum : float
        Step of the converter.
    """

    white: float
    coloured: float = 0.0
    corner_hz: float = 20.0
    hum: float = 0.0
    wander: float = 0.0
    quantum: float = 0.0

    def add(self, clean: np.ndarray, sample_rate: float, random: np.random.Generator) -> np.ndarray:
        """What is logged of a clean channel, (n,) to (n,)."""
        n = len(clean)
        time = np.arange(n) / sample_rate
        noise = np.sqrt(1.0 - self.coloured) * random.standard_normal(n)
        if self.coloured:
            keep = float(np.exp(-2.0 * np.pi * self.corner_hz / sample_rate))
            first = random.standard_normal()
            drive = np.sqrt(1.0 - keep**2) * random.standard_normal(n)
            noise = noise + np.sqrt(self.coloured) * lfilter([1.0], [1.0, -keep], drive, zi=[keep * first])[0]
        phase, third, slow = random.uniform(0.0, 2.0 * np.pi, 3)
        line = np.sin(2.0 * np.pi * 60.0 * time + phase)
        if sample_rate > 400.0:
            line = line + 0.2 * np.sin(2.0 * np.pi * 180.0 * time + third)
        wander = random.uniform(-1.0, 1.0) * np.cos(0.5 * np.pi * np.arange(n) / n + slow)
        dirty = clean + self.white * noise + self.hum * line + self.wander * wander
        return quantise(dirty, self.quantum)


def random_accelerometer(random: np.random.Generator, quiet: bool = False) -> Disturbance:
    """Noise 7 to 13 mm/s², mains 0.03 to 0.15 (now and then ten times that), 12 or 16 bits over 5 V at 0.15 V s²/m.

    The zero wanders by 2 mg (0.02 m/s²) within a recording at most.
    """
    hum = random.uniform(0.03, 0.15) * (10.0 if random.random() < 0.1 and not quiet else 1.0)
    coloured = random.choice([0.0, random.uniform(0.1, 0.6)])
    bits = int(random.choice([12, 14, 16]))
    return Disturbance(
        white=random.uniform(0.007, 0.013),
        coloured=float(coloured),
        corner_hz=random.uniform(5.0, 60.0),
        hum=hum,
        wander=random.uniform(0.0, 0.02),
        quantum=5.0 / 2**bits / 0.15,
    )


def random_load_cell(random: np.random.Generator) -> Disturbance:
    """Noise 0.4 to 1 N, a zero that creeps by 0.05 N at most (0.01 % of a 500 N cell), 1 mN steps as printed."""
    coloured = random.choice([0.0, random.uniform(0.1, 0.5)])
    return Disturbance(
        white=random.uniform(0.4, 1.0),
        coloured=float(coloured),
        corner_hz=random.uniform(1.0, 10.0),
        wander=random.uniform(0.0, 0.05),
        quantum=1e-3,
    )
