"""rig.yaml of several bodies: as many as sensors that see modes, with frequencies as the logs show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.signal import find_peaks, welch

from ssmr_ident.core.parameter import GROUND, Estimate, ParameterSet
from ssmr_ident.session.entry import FURTHER
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.workflows.new.log import LogGuess
from ssmr_ident.workflows.new.rig import FIRST_LOOK, rounded

SENSORS = ("acceleration", *(name for name in FURTHER if name.startswith("acceleration")))

OVER_AROUND, OVER_LARGEST = 10.0, 1e-3
"""Choice: times that a mode's line stands over the median around it, and share of the highest line, to be seen."""

DAMPING = 0.02
"""Choice: damping ratio from which a fit begins."""


@dataclass(frozen=True)
class Modes:
    """What the spectra of all sensors show.

    Parameters
    ----------
    hz : tuple of float [Hz]
        Of the modes, from the lowest.
    sensors : tuple of str
        Headers of the accelerations.
    driven : str
        Header of the one that moves with the force in every mode, as the one beside it must; empty for none.
    against : bool
        Whether that one moves against the force instead: its sign is turned.
    """

    hz: tuple[float, ...]
    sensors: tuple[str, ...]
    driven: str = ""
    against: bool = False

    @property
    def bodies(self) -> int:
        """Of the network that is proposed: one for each sensor, where there are as many modes."""
        return len(self.sensors) if len(self.hz) >= len(self.sensors) else 1


def modes_seen(guesses: Sequence[LogGuess]) -> Modes:
    """Modes in the accelerations of all logs of a rig, each line in sizes of its sensor's loudest."""
    sensors = [header for header in _accelerations(guesses[0]) if all(header in _accelerations(g) for g in guesses)]
    if not 2 <= len(sensors) <= len(SENSORS):
        return Modes((), tuple(sensors))
    total, grid = np.zeros(0), np.zeros(0)
    across: list[tuple[np.ndarray, np.ndarray]] = []
    for guess in guesses:
        recording = guess.recording
        drive = next((name for name in ("force", "torque") if name in recording), "")
        columns = [_accelerations(guess)[header] for header in sensors] + ([recording[drive]] if drive else [])
        even = even_samples(recording.time, np.column_stack(columns))
        y, long = even.samples - even.samples.mean(axis=0), len(even.samples)
        hz, power = welch(y[:, : len(sensors)], even.sample_rate, nperseg=long, axis=0)
        share = (power / power.max(axis=0)).sum(axis=1)
        grid = hz if len(grid) == 0 else grid
        total = np.interp(grid, hz, share) + (total if len(total) else 0.0)
        if drive:
            turned = np.fft.rfft(y, axis=0)
            found = (turned[:, :-1] * turned[:, -1:].conj()).T
            across.append((hz, found))
    around = len(grid) // 40 + 5
    level = np.array([np.median(total[max(0, k - around) : k + around]) for k in range(len(grid))])
    peaks, _ = find_peaks(total, height=OVER_LARGEST * total.max(), distance=3)
    lines = [k for k in peaks.tolist() if total[k] > OVER_AROUND * level[k]]
    loudest = sorted(sorted(lines, key=lambda k: -total[k])[: len(sensors)])
    modes = Modes(tuple(float(grid[k]) for k in loudest), tuple(sensors))
    return _with_drive(modes, across)


def _accelerations(guess: LogGuess) -> dict[str, np.ndarray]:
    """By header; that of a foot is none of them."""
    channels = (c for c in guess.recording.channels if c.unit == "m/s^2" and not c.name.startswith("base"))
    return {c.label or c.name: c.samples for c in channels}


def _with_drive(modes: Modes, across: Sequence[tuple[np.ndarray, np.ndarray]]) -> Modes:
    """At its own place a force moves every mode to one side: an acceleration at resonance by its imaginary part."""
    if not across or not modes.hz:
        return modes
    at = [[np.interp(modes.hz, hz, own.imag) for own in found] for hz, found in across]
    signs = np.sign(np.sum(at, axis=0))
    for sensor, own in zip(modes.sensors, signs, strict=True):
        if np.all(own == own[0]) and own[0] != 0.0:
            return replace(modes, driven=sensor, against=bool(own[0] < 0.0))
    return modes


def network_text(name: str, modes: Modes, mass: float | None) -> str:
    """rig.yaml: equal masses, each on the ground and joined to the next, stiff as the lowest and highest mode say."""
    own = 1.0 if mass is None else mass / modes.bodies
    source = "nobody said: 1 kg each" if mass is None else "given to ident new, in equal parts"
    low, high = (2.0 * np.pi * f for f in (modes.hz[0], modes.hz[-1]))
    reach = 2.0 if modes.bodies == 2 else 4.0  # of a chain's highest mode, over that of one spring between two masses
    springs = {f"ground_{body}": (GROUND, body, low**2) for body in names_of(modes).values()}
    bodies = list(names_of(modes).values())
    joined = pairwise(bodies)
    springs |= {f"{a}_{b}": (a, b, (high**2 - low**2) / reach) for a, b in joined}
    estimates = {f"bodies.{body}.mass_kg": Estimate(own, None, "kg", source) for body in bodies}
    for spring, (_, _, ratio) in springs.items():
        stiff = rounded(own * ratio)
        estimates[f"springs.{spring}.stiffness_N_m"] = Estimate(stiff, None, "N/m", FIRST_LOOK)
        damping = rounded(2.0 * DAMPING * (own * stiff) ** 0.5)
        estimates[f"springs.{spring}.damping_N_s_m"] = Estimate(damping, None, "N s/m", FIRST_LOOK)
    between = {spring: (a, b) for spring, (a, b, _) in springs.items()}
    lines = [
        "# Written by `ident new`. Add std: the standard deviation that you believe in; left out, it means unknown.",
        f"# {len(modes.hz)} modes are seen, at {', '.join(f'{f:.4g}' for f in modes.hz)} Hz: a body for each sensor.",
        "# Take out springs that are not there; ident fit prints the modes of what is left.",
    ]
    return "\n".join([*lines, ""]) + parameters_text(ParameterSet(name, estimates, between=between))


def names_of(modes: Modes) -> dict[str, str]:
    """The body on which each sensor sits, as it is called until somebody knows better."""
    return {header: f"body_{number}" for number, header in enumerate(modes.sensors, start=1)}


def placed(guess: LogGuess, modes: Modes) -> LogGuess:
    """A log's channels with their bodies."""
    places = names_of(modes)
    drive = places.get(modes.driven, next(iter(places.values())))
    fields, reasons = dict(guess.fields), dict(guess.reasons)
    known = {q: header for q, header in fields.get("channels", {}).items() if q.startswith("base")}
    quantities = zip(SENSORS, modes.sensors, strict=False)
    channels = {quantity: {"column": header, "body": places[header]} for quantity, header in quantities}
    for c in (c for c in guess.recording.channels if c.name == "force"):
        channels["force"] = {"column": c.label or c.name, "body": drive}
    fields["channels"] = {**known, **channels}
    if "force" in channels and modes.driven:
        how = "with the force in every mode"
        if modes.against:
            how = "against the force in every mode; per_volt: {force: -1} with units: {HEADER: V} turns a force's sign?"
        reasons["channels"] = f"the force acts where the sensor moves {how}"
    elif "force" in channels:
        reasons["channels"] = "no sensor moves with the force in every mode: on which body does it act?"
    return replace(guess, fields=fields, reasons=reasons)
