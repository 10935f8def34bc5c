"""From a campaign to trials and a model: which recordings are fitted, which are kept back, what may move."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.parameter import ParameterSet
from ssmr_ident.diagnose.arranged import loudness
from ssmr_ident.diagnose.noise_at_rest import coloured, colours_at_rest
from ssmr_ident.experiments import EXPERIMENTS
from ssmr_ident.experiments.campaign import Campaign, Measurement
from ssmr_ident.identify.body.builder import GAINS
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.posterior.objective import Unknown
from ssmr_ident.identify.robot.unknowns import robot_unknowns
from ssmr_ident.identify.trials import Trial, trial_of
from ssmr_ident.physics.rig import RIG_KEYS
from ssmr_ident.physics.slots import effect_values

COUPLING = "translation_coupling"

KEPT_BACK = 1 / 3
"""Share of the targets that is kept back where a session has no held-out recordings."""

BANDWIDTH = "accelerometer.bandwidth_hz"

SENSITIVITY = "accelerometer.volts_per_m_s2"

SHEET = 3.0
"""Standard deviations by which a sensor's bandwidth may be off its sheet before it is an effect."""


@dataclass(frozen=True, eq=False)
class Setup:
    """What a diagnosis works on.

    Parameters
    ----------
    campaign : Campaign
    fitted, kept : tuple of Trial
        Recordings that are fitted, and those that never are until the end.
    model : Model
        The baseline with its priors.
    known : tuple of Unknown
        Priors to hold fitted values against (the model may have set some aside).
    kept_by_us : bool
        True where the session held nothing back and the tool did.
    notes : tuple of str
    calibration : tuple of Trial
        Made without the puzzling condition: what they tell of the baseline is known before the targets are looked at.
    """

    campaign: Campaign
    fitted: tuple[Trial, ...]
    kept: tuple[Trial, ...]
    model: Model
    known: tuple[Unknown, ...]
    kept_by_us: bool
    notes: tuple[str, ...] = ()
    calibration: tuple[Trial, ...] = ()

    @property
    def decoupled(self) -> bool:
        """Whether motions are pure rotations still."""
        return self.campaign.session.baseline == "decoupled" and COUPLING not in self.model.held


def set_up(campaign: Campaign, parameters: ParameterSet) -> Setup:
    """Prepare a session.

    Parameters
    ----------
    campaign : Campaign
    parameters : ParameterSet
        What is known beforehand.

    Raises
    ------
    InputError
        A baseline and an experiment that do not go together, or nothing to fit.
    """
    baseline = campaign.session.baseline
    for m in campaign.measurements:
        if not m.experiment.fitted_under(baseline):
            possible = [name for name, kind in EXPERIMENTS.items() if kind.fitted_under(baseline)]
            raise InputError(
                f"{campaign.session.folder / 'session.yaml'}: {m.name}",
                f"a {m.entry.experiment} beside other experiments cannot be diagnosed with baseline {baseline}",
                f"Make a session of its own of it; here: {', '.join(possible)}",
            )
    calibration = [m for m in campaign.measurements if m.entry.role == "calibration"]
    targets = [m for m in campaign.measurements if m.entry.role == "target"]
    heldout = [m for m in campaign.measurements if m.entry.role == "heldout"]
    if not targets:
        targets, calibration = calibration, []
    if not targets:
        raise InputError(
            f"{campaign.session.folder}/session.yaml: recordings",
            "all are heldout, so nothing may be fitted",
            "Give at least one recording role: target",
        )
    notes: list[str] = []
    by_us = not heldout
    if by_us:
        targets, heldout = keep_back(targets)

    def make(m: Measurement) -> Trial:
        return trial_of(baseline, m, parameters)

    halves: list[Trial] = []
    if not heldout:
        whole = make(targets[0])
        first, second = split_in_time(whole)
        halves, fitted = [second], [first]
        cut = second.part[0] if second.part else 0.0
        notes.append(f"{whole.name} is the only recording: it was fitted up to {cut:.4g} s and held out after")
    else:
        fitted = [make(m) for m in targets]
        halves = [make(m) for m in heldout]
        if by_us:
            names, verb = ", ".join(m.name for m in heldout), "was" if len(heldout) == 1 else "were"
            notes.append(f"the session holds nothing back, so {names} {verb} kept back from the fits that decided")
    known = unknowns_of(campaign, parameters)
    held = {name: dict(values) for name, values in effect_values(parameters).items()}
    # pure rotations are held to their priors as well: it is by the inertia that they ask for that they are found out
    model = Model(tuple(known), (), held)
    if calibration:
        notes.append(
            f"the baseline comes from {len(calibration)} calibration recordings; the question is what the others have "
            "that they have not"
        )
    before = [make(m) for m in calibration]
    colours = colours_at_rest([*fitted, *before])
    told, kept, known_before = (tuple(coloured(t, colours) for t in trials) for trials in (fitted, halves, before))
    return Setup(campaign, told, kept, model, known, by_us, tuple(notes), known_before)


def keep_back(targets: list[Measurement]) -> tuple[list[Measurement], list[Measurement]]:
    """Split targets: of every kind of experiment the last third, as long as one is left to fit.

    The kind is the experiment, its motion or direction and its grip, so that what is kept back is like what is fitted.
    """
    kinds: dict[tuple[object, ...], list[Measurement]] = {}
    for m in targets:
        kinds.setdefault((m.entry.experiment, m.entry.motion, m.entry.direction), []).append(m)
    kept = [m for group in kinds.values() for m in _last(group)]
    if not kept:
        # pairs: the quieter one of as many kinds as make up the share, at least one
        pairs = [sorted(group, key=loudness)[0] for group in kinds.values() if len(group) > 1]
        kept = pairs[: max(1, round(KEPT_BACK * len(targets)))]
    if not kept and len(targets) > 1:
        kept = [min(targets, key=loudness)]
    return [m for m in targets if m not in kept], [m for m in targets if m in kept]


def _last(group: list[Measurement]) -> list[Measurement]:
    """The loudest of a kind is never kept back: what is fitted should span what is predicted."""
    count = int(KEPT_BACK * len(group) + 1e-9)
    if not count:
        return []
    ordered = sorted(group, key=loudness)
    middle = ordered[1:-1] or ordered[:-1]
    spread = np.linspace(0, len(middle) - 1, min(count, len(middle))).round().astype(int)
    return [middle[i] for i in dict.fromkeys(spread.tolist())]


def split_in_time(trial: Trial) -> tuple[Trial, Trial]:
    """The first two thirds of a lone recording, and the rest; both are simulated from its start."""
    count = len(trial.times)
    cut = round((1.0 - KEPT_BACK) * count)
    inside = np.ones((count, len(trial.channels)), dtype=bool) if trial.counts is None else trial.counts
    early, late = inside.copy(), inside.copy()
    early[cut:], late[:cut] = False, False
    times = trial.times
    # what is shortened would lose the mask
    first = replace(trial, counts=early, shorten=None, delay=None, part=(float(times[0]), float(times[cut - 1])))
    return first, replace(trial, counts=late, shorten=None, delay=None, part=(float(times[cut]), float(times[-1])))


def twin(path: str, parameters: ParameterSet) -> str | None:
    """The static friction that a kinetic one is the same number as.

    A file in which both are equal says that contacts slide at the force at which they let go: one unknown, and a
    saw-tooth in a pull is something that this baseline has not.
    """
    if not path.endswith("mu_kinetic"):
        return None
    other = path.replace("kinetic", "static")
    if other not in parameters or parameters[other].fixed or parameters[path].fixed:
        return None
    return other if float(parameters[other].value) == float(parameters[path].value) else None


def unknowns_of(campaign: Campaign, parameters: ParameterSet) -> tuple[Unknown, ...]:
    """What the baseline may move, with what is known of it."""
    baseline = campaign.session.baseline
    if baseline in ("rigid6", "decoupled"):
        keys: tuple[str, ...] = ()
        found = list(robot_unknowns(parameters))
    else:
        found = []
        keys = RIG_KEYS["inertia_kg_m2" in parameters]
    found = [u for u in found if twin(u.name, parameters) is None]
    for key in (k for k in (*keys, BANDWIDTH) if twin(k, parameters) is None):
        if key not in parameters or parameters[key].fixed or (key == BANDWIDTH and parameters[key].std is None):
            continue
        value = float(parameters[key].value)
        if np.isfinite(value):
            std = parameters[key].std
            known = None if std is None else max(std, 1e-9)
            # a sensor slower than any uncertainty of its sheet is an effect
            reach = SHEET if key == BANDWIDTH else np.inf
            found.append(Unknown(key, parameters[key].unit, value, known, reach=reach))
    return (*found, *(_gains(campaign, parameters) if baseline == "rigid6" else ()))


def _gains(campaign: Campaign, parameters: ParameterSet) -> list[Unknown]:
    """What each axis of the accelerometer reads, as far as its sheet leaves that open.

    Of a single axis the size of the push cannot be told from it.
    """
    logged = {name for m in campaign.measurements if m.experiment.free for name in m.recording.names}
    found = []
    for name in (n for n in GAINS if f"a{n[-1]}" in logged):
        value, std = parameters.number(name, 1.0), parameters[name].std if name in parameters else None
        sheet = parameters.get(SENSITIVITY)
        if std is None and sheet is not None and sheet.std is not None and not sheet.fixed:
            std = sheet.std / abs(float(sheet.value))
        if std is not None and std > 0.0 and not (name in parameters and parameters[name].fixed):
            found.append(Unknown(name, "1", value, std))
    return found if len(found) > 1 else []
