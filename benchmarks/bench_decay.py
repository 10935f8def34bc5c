"""How good are ω_n and ξ of a decay, against the Cramér–Rao bound and the usual methods? Prints one table.

Monte-Carlo: 2048 samples at 1 kHz, white noise, random phases, an offset; amplitude over noise 100 and 10. Run it
as ``python benchmarks/bench_decay.py [RUNS]``; the columns are RMSE over bound, then coverage of the 95 % intervals.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np

from ssmr_ident.identify.decays.classical import fft_grid, half_power, logarithmic_decrement, pencil
from ssmr_ident.identify.decays.fit import fit_decay

CASES = {
    "10 Hz, xi 0.02": [(10.0, 0.02)],
    "10 Hz, xi 0.05": [(10.0, 0.05)],
    "4 Hz, xi 0.10": [(4.0, 0.10)],
    "10 and 10.5 Hz, xi 0.02": [(10.0, 0.02), (10.5, 0.02)],
}
STEP, COUNT = 1e-3, 2048


def signal(modes: list[tuple[float, float]], phases: np.ndarray) -> np.ndarray:
    """Decays of unit amplitude, natural frequencies in Hz."""
    times = STEP * np.arange(COUNT)
    total = np.zeros(COUNT)
    for (frequency, xi), phase in zip(modes, phases, strict=True):
        omega = 2 * np.pi * frequency
        total += np.exp(-xi * omega * times) * np.sin(omega * np.sqrt(1 - xi**2) * times + phase)
    return total


def bound(modes: list[tuple[float, float]], phases: np.ndarray, noise: float) -> np.ndarray:
    """Cramér–Rao bound of (ω_n, ξ) of each mode, by finite differences of the model: independent of the fit."""
    modes_list = [value for mode in modes for value in mode]

    def model(values: np.ndarray) -> np.ndarray:
        count = len(modes)
        pairs = [(values[2 * k] / 2 / np.pi, values[2 * k + 1]) for k in range(count)]
        times = STEP * np.arange(COUNT)
        total = np.full(COUNT, values[-1])
        for k, (frequency, xi) in enumerate(pairs):
            omega = 2 * np.pi * frequency
            amplitude, phase = values[2 * count + 2 * k], values[2 * count + 2 * k + 1]
            wave = np.sin(omega * np.sqrt(1 - xi**2) * times + phase)
            total = total + amplitude * np.exp(-xi * omega * times) * wave
        return total

    start = np.array(modes_list + [value for phase in phases for value in (1.0, phase)] + [0.3])
    start[0 : 2 * len(modes) : 2] *= 2 * np.pi
    columns = []
    for index in range(len(start)):
        move = np.zeros(len(start))
        move[index] = 1e-6 * max(abs(start[index]), 1.0)
        columns.append((model(start + move) - model(start - move)) / (2 * move[index]))
    jacobian = np.column_stack(columns)
    return noise * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))[: 2 * len(modes)]


def run(case: str, ratio: float, runs: int, seed: int = 20120611) -> dict[str, np.ndarray | float]:
    """Errors over bound of every method, and coverage and time of ours.

    Returns
    -------
    dict
        ``ours``: (runs, 2k) errors over bound; ``covered``: (runs, 2k) bool; ``orders``: share with the right
        number of modes; ``ms``: median time per decay; and one array per classical method (first mode only).
    """
    modes = CASES[case]
    rng = np.random.default_rng([seed, list(CASES).index(case), round(ratio)])
    truth = np.array([value for f, xi in modes for value in (2 * np.pi * f, xi)])
    times = STEP * np.arange(COUNT)
    ours, covered, right, spent = [], [], 0, []
    classical: dict[str, Callable[[np.ndarray, float], tuple[float, float]]] = {
        "log decrement": logarithmic_decrement,
        "half power": half_power,
        "FFT grid": fft_grid,
        "matrix pencil": lambda y, step: (pencil(y, step, len(modes)) or [(np.nan, np.nan)])[0],
    }
    others: dict[str, list[np.ndarray]] = {name: [] for name in classical}
    for _ in range(runs):
        phases = rng.uniform(-np.pi, np.pi, len(modes))
        record = 0.3 + signal(modes, phases) + rng.normal(size=COUNT) / ratio
        limit = bound(modes, phases, 1.0 / ratio)
        begin = time.perf_counter()
        fit = fit_decay(times, record, start_s=0.0)
        spent.append(time.perf_counter() - begin)
        if len(fit.modes) == len(modes):
            right += 1
            found = np.array([value for mode in fit.modes for value in (mode.omega_n, mode.xi)])
            stds = np.array([value for mode in fit.modes for value in (mode.omega_n_std, mode.xi_std)])
            ours.append((found - truth) / limit)
            covered.append(np.abs(found - truth) < 1.959964 * stds)
        for name, method in classical.items():
            others[name].append((np.array(method(record - 0.3, STEP)) - truth[:2]) / limit[:2])
    return {
        "ours": np.array(ours),
        "covered": np.array(covered),
        "orders": right / runs,
        "ms": 1e3 * float(np.median(spent)),
        **{name: np.array(rows) for name, rows in others.items()},
    }


def rms(rows: np.ndarray) -> np.ndarray:
    """Root mean square over runs, failures left out."""
    return np.sqrt(np.nanmean(rows**2, axis=0))


def main() -> None:
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    names = ("log decrement", "half power", "FFT grid", "matrix pencil")
    print(f"{runs} runs each; RMSE over Cramér-Rao bound (omega_n, xi), coverage of the 95 % interval")
    head = f"{'case':<25}{'A/noise':>8}  {'fit_decay':<24}{'coverage %':<21}{'order':>6}{'ms':>6}   "
    print(head + "   ".join(names))
    for case in CASES:
        for ratio in (100.0, 10.0):
            result = run(case, ratio, runs)
            error = " ".join(f"{value:.3f}" for value in rms(np.asarray(result["ours"])))
            covered = " ".join(f"{100 * value:.1f}" for value in np.asarray(result["covered"]).mean(axis=0))
            rest = "   ".join("{:.3g}, {:.3g}".format(*rms(np.asarray(result[name]))) for name in names)
            ours = f"{error:<24}{covered:<21}{result['orders']:>6.2f}{result['ms']:>6.2f}"
            print(f"{case:<25}{ratio:>8.0f}  {ours}   {rest}")


if __name__ == "__main__":
    main()
