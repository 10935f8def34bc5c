"""Bode plot of what stands between a vibration and its spectrum (3.2): accelerometer and Butterworth filters.

``python -m thesis2012.bode`` in studies/ writes docs/theory/bode.png.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy import signal

from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.report import style
from ssmr_ident.signals.filters import FREE_RESPONSE_LOW_PASS_HZ, SWIVEL_LOW_PASS_HZ, design

RATE = 1000.0
BANDWIDTH_HZ = 80.0
COMMAND = "python -m thesis2012.bode"
FOLDER = Path(__file__).resolve().parents[2] / "docs" / "theory"


def responses(frequency: np.ndarray) -> dict[str, np.ndarray]:
    """Transfer functions at ``frequency`` [Hz], (n,) complex each: the filters of one pass, twice, and the sensor."""
    found = {}
    for edge in (SWIVEL_LOW_PASS_HZ, FREE_RESPONSE_LOW_PASS_HZ):
        filtered = design(RATE, upper_hz=edge)
        assert filtered is not None  # the edge lies below half the rate
        once = signal.sosfreqz(filtered.sections, frequency, fs=RATE)[1]
        found[f"low-pass {edge:g} Hz, one pass"] = once
        found[f"low-pass {edge:g} Hz, forward and backward"] = np.abs(once) ** 2 + 0j
    b0, b1, b2, a1, a2 = low_pass_coefficients(BANDWIDTH_HZ, 1.0 / RATE)
    found[f"accelerometer, {BANDWIDTH_HZ:g} Hz"] = signal.freqz([b0, b1, b2], [1.0, a1, a2], frequency, fs=RATE)[1]
    return found


@style.house
def figure() -> Figure:
    """Gain above, phase below."""
    frequency = np.geomspace(1.0, 300.0, 1500)
    drawn = style.new_figure(style.DOUBLE_COLUMN, 4.2)
    gain, phase = drawn.subplots(2, 1, sharex=True)
    for index, (name, response) in enumerate(responses(frequency).items()):
        look = {"color": style.SERIES[index], "ls": "--" if "backward" in name else "-"}
        gain.semilogx(frequency, 20.0 * np.log10(np.maximum(np.abs(response), 1e-12)), label=name, **look)
        phase.semilogx(frequency, np.rad2deg(np.unwrap(np.angle(response))), **look)
    gain.set_ylim(-80.0, 5.0)
    gain.set_ylabel("gain [dB]")
    phase.set_ylim(-920.0, 30.0)
    phase.set_ylabel("phase [°]")
    phase.set_xlabel("frequency [Hz]")
    drawn.legend(loc="outside lower center", ncols=2)
    return drawn


if __name__ == "__main__":
    print(f"written to {style.save(figure(), FOLDER / 'bode', command=COMMAND)}")
