"""A parameter file to start from: what the logs tell at first sight, and a question for everything else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import csd

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import Estimate, ParameterSet
from ssmr_ident.identify.decays.classical import half_power
from ssmr_ident.identify.rigs.frequency_domain import DERIVATIVES
from ssmr_ident.physics.rig import RIG_KEYS
from ssmr_ident.session import read_parameters
from ssmr_ident.session.parameters_text import parameters_text
from ssmr_ident.workflows.new.log import MOTIONS, LogGuess

FIRST_LOOK = "first look at the logs: a start for the fit, no knowledge"
QUESTIONS = {
    "mass_kg": "weigh it; what moves, for a rig",
    "inertia_kg_m2": "of what turns: calculate it from its parts, or weigh and swing it",
    "inertia_kg_m2.xx": "from CAD, or from `ident geometry` (weighings and a list of parts)",
    "inertia_kg_m2.yy": "likewise",
    "inertia_kg_m2.zz": "likewise",
    "contact_points_m": "four rows [x, y, z] from the centre of mass: rear left, front left, front right, rear right",
    "accelerometer.position_m": "[x, y, z] from the centre of mass, x forward, y left, z up",
    "accelerometer.volts_zero": "reading without acceleration, by the data sheet",
    "accelerometer.volts_per_m_s2": "sensitivity, by the data sheet",
    "tire.radius_m": "of the wheels",
    "stiffness_N_m": "a start for the fit: mass·(2π·f)², f the frequency at which it rings",
    "stiffness_N_m_rad": "a start for the fit: inertia·(2π·f)², f the frequency at which it rings",
    "damping_N_s_m": "a start for the fit: a few percent of 2·√(mass·stiffness)",
    "damping_N_m_s_rad": "a start for the fit: a few percent of 2·√(inertia·stiffness)",
    "mu_static": "highest force over the weight",
    "mu_kinetic": "level of the force over the weight",
}
_UNITS = {"mass_kg": "kg", "damping_N_s_m": "N s/m", "stiffness_N_m": "N/m", "inertia_kg_m2": "kg m^2"}
_UNITS |= {"damping_N_m_s_rad": "N m s/rad", "stiffness_N_m_rad": "N m/rad"}
_G = 9.81
"""Good enough for a start."""


def robot_text(name: str, template: str, guesses: Sequence[LogGuess]) -> str:
    """robot.yaml of a robot: a bundled one's values where ``template`` names it, else questions.

    What the logs do not need is not asked for: the sensor's place without accelerations, its volts without volts.

    Raises
    ------
    InputError
        An unknown template.
    """
    known = read_parameters(template or "p3at-extended")
    units = {c.unit for guess in guesses if guess.kind == "robot" for c in guess.recording.channels}
    asked = set(QUESTIONS) - (set() if units else {"accelerometer.position_m"})
    asked -= set() if "V" in units else {"accelerometer.volts_zero", "accelerometer.volts_per_m_s2"}
    changes = {}
    for key, estimate in known.estimates.items():
        if template:
            changes[key] = replace(estimate, source=f"{template}: {estimate.source}" if estimate.source else template)
        elif key in asked:
            changes[key] = replace(estimate, value=math.nan, std=None, source="")
        elif key.startswith("inertia"):
            changes[key] = replace(estimate, value=0.0, std=None, source="taken as symmetric")
        elif key.startswith(("accelerometer.", "noise.")):
            changes[key] = replace(estimate, std=None, source="the p3at's sensor: see your data sheet")
        elif not estimate.fixed:
            changes[key] = replace(estimate, std=None, source="the p3at's: a start for the fit, no knowledge")
    text = parameters_text(ParameterSet(name, {**known.estimates, **changes}))
    head = [
        "# Written by `ident new`. std is the standard deviation that you believe in; left out, it means unknown, and",
        "# the fit starts from the value without being held by it. fixed: true leaves a value alone.",
        f"# Values of the bundled robot {template}: replace what you know of yours."
        if template
        else "# A line that says TODO needs a number. `ident new --robot p3at-extended` starts from that robot's.",
    ]
    return "\n".join([*head, ""]) + _asked(text)


def rig_text(name: str, guesses: Sequence[LogGuess], mass: float | None) -> str:
    """robot.yaml of a rig with one mass: mass, damper and spring at first sight."""
    rotary = any(guess.rotary for guess in guesses)
    keys = RIG_KEYS[rotary]
    forced = [guess for guess in guesses if guess.experiment and guess.experiment.driven]
    seen = _forced(forced, rotary) if forced else None
    note = ""
    if seen is not None:
        values: tuple[float, ...] = seen
    else:
        omega, xi = _free(guesses)
        inertia = math.nan if mass is None else mass
        values = (inertia, 2.0 * xi * omega * inertia, omega**2 * inertia)
        if math.isfinite(omega):
            note = f"{omega**2:.4g} and {2.0 * xi * omega:.3g} times the {keys[0].split('_')[0]}, by a free response"
    estimates = {key: Estimate(value, None, _UNITS[key], FIRST_LOOK) for key, value in zip(keys, values, strict=True)}
    if mass is not None:
        estimates[keys[0]] = Estimate(mass, None, _UNITS[keys[0]], "given to ident new")
    lines = [
        "# Written by `ident new`. Add std: the standard deviation that you believe in; left out, it means unknown.",
        "# fixed: true leaves a value alone; a stiffness of 0 with fixed: true means that there is no spring.",
    ]
    if note:
        lines.append(f"# stiffness and damping are {note}: --mass-kg fills them in.")
    return "\n".join([*lines, ""]) + _asked(parameters_text(ParameterSet(name, estimates)))


def block_text(name: str, guesses: Sequence[LogGuess], mass: float | None) -> str:
    """robot.yaml of a dragged block: friction from the level and the highest force."""
    forces = [np.abs(guess.recording["force"]) for guess in guesses if "force" in guess.recording]
    weight = math.nan if mass is None else mass * _G
    level = float(np.median([np.median(force[len(force) // 2 :]) for force in forces])) if forces else math.nan
    highest = float(np.median([np.max(force) for force in forces])) if forces else math.nan
    estimates = {
        "mass_kg": Estimate(math.nan if mass is None else mass, None, "kg", "given to ident new"),
        "mu_static": Estimate(highest / weight, None, "1", FIRST_LOOK),
        "mu_kinetic": Estimate(level / weight, None, "1", FIRST_LOOK),
        "cable.stiffness_N_m": Estimate(math.inf, None, "N/m", "taken as stiff", fixed=True),
    }
    lines = [f"# Written by `ident new`. The force is {level:.4g} N in the middle and {highest:.4g} N at most:"]
    lines.append("# friction is that over the weight; --mass-kg fills it in. Add std where you know one.")
    return "\n".join([*lines, ""]) + _asked(parameters_text(ParameterSet(name, estimates)))


def _asked(text: str) -> str:
    """NaN becomes TODO with a question."""
    lines = []
    for line in text.splitlines():
        if "value: nan" in line:
            key = line.split(":", 1)[0].strip()
            question = next(q for path, q in QUESTIONS.items() if path.rsplit(".", 1)[-1] == key)
            unit = line.split("unit: ", 1)[1].split('"')[1]
            line = f'{line.split("{", 1)[0]}{{value: TODO, unit: "{unit}"}}  # {question}'
        lines.append(line)
    return "\n".join(lines) + "\n"


def _forced(guesses: Sequence[LogGuess], rotary: bool) -> tuple[float, float, float] | None:
    """Mass, damping, stiffness of 1/(K − M·ω² + i·D·ω), fitted to the measured response by linear least squares.

    The equation's error is divided by the last round's denominator (Sanathanan and Koerner 1963), which makes it the
    output's, and weighted by the coherence. None where no positive mass and spring come out.
    """
    parts = [part for guess in guesses for part in [_response(guess, rotary)] if part is not None]
    if not parts:
        return None
    omega, response, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    scale = np.array([1.0 / omega.mean() ** 2, 1.0 / omega.mean(), 1.0])
    columns = np.stack([-(omega**2), 1j * omega, np.ones_like(omega)], axis=1) * scale
    last = np.ones_like(response) / np.median(np.abs(response))
    for _ in range(20):
        matrix, right = columns * (response * weight / last)[:, None], weight / last
        stacked, sides = np.concatenate([matrix.real, matrix.imag]), np.concatenate([right.real, right.imag])
        found = np.linalg.lstsq(stacked, sides, rcond=None)[0]
        last = columns @ found
    mass, damping, stiffness = found * scale
    if not (mass > 0 and stiffness > 0):
        return None
    damping = max(damping, 0.02 * math.sqrt(mass * stiffness))
    return _digits(mass), _digits(damping), _digits(stiffness)


def _digits(value: float) -> float:
    return float(f"{value:.4g}")


def _response(guess: LogGuess, rotary: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """ω, position over force (Welch, eight segments), and a weight by the coherence, where the force has power."""
    recording = guess.recording
    samples = {c.name: c.samples for c in recording.channels}
    for quantity, header in guess.fields.get("channels", {}).items():
        samples |= {q: c.samples for q in (quantity,) for c in recording.channels if header in (c.label, c.name)}
    name = next((name for name in MOTIONS if name in samples and name in DERIVATIVES), None)
    if name is None:
        return None
    force, motion = samples["torque" if rotary and "torque" in samples else "force"], samples[name]
    rate = recording.sample_rate
    length = max(64, len(force) // 4) if len(force) > 64 else len(force)
    frequency, cross = csd(force, motion, rate, nperseg=length)
    power, own = (csd(x, x, rate, nperseg=length)[1].real for x in (force, motion))
    use = (frequency > 2.0 * rate / length) & (frequency < rate / 4) & (power > 1e-3 * np.max(power[1:]))
    if np.count_nonzero(use) < 3:
        return None
    coherence = np.clip(np.abs(cross[use]) ** 2 / (power[use] * own[use]), 0.0, 0.999)
    omega = 2 * np.pi * frequency[use]
    response = cross[use] / power[use] / (1j * omega) ** DERIVATIVES[name]
    return omega, response, np.sqrt(coherence / (1.0 - coherence)) / np.abs(response)


def _free(guesses: Sequence[LogGuess]) -> tuple[float, float]:
    """ω_n [rad/s] and ξ of the first free response by the half-power width; NaN where there is none."""
    for guess in guesses:
        recording = guess.recording
        name = next((name for name in MOTIONS if name in recording), None)
        if guess.experiment and guess.experiment.free and name is not None:
            try:
                omega, xi = half_power(recording[name], 1.0 / recording.sample_rate)
            except (ValueError, InputError):
                continue
            if math.isfinite(omega) and 0 < xi < 1:
                return omega, xi
    return math.nan, math.nan
