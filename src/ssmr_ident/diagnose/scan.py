"""Score test over the catalogue: which effect, added a little, would point the simulation towards the recordings.

The change that an effect makes is simulated at the baseline's best, whitened, and cleared of what the baseline's own
parameters and nuisances could do as well; what is left is matched against the residual. That ranks all effects for
the price of a simulation each. Source: Cox and Hinkley, Theoretical Statistics (1974), section 9.3 (score test).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.parameter import Parameter
from ssmr_ident.core.threads import side_by_side
from ssmr_ident.diagnose.cleared import Cleared
from ssmr_ident.diagnose.sizes import sizes_of
from ssmr_ident.diagnose.weigh import CERTAIN
from ssmr_ident.identify.fitting.coordinates import Model
from ssmr_ident.identify.fitting.joint import JointFit, over
from ssmr_ident.physics.effect import Effect, Sized
from ssmr_ident.physics.effects import CATALOGUE

Array = np.ndarray

ROUNDING = 1e-10
"""Share of a direction's own curvature below which what is left of it is rounding."""

PROMISING = 6.0
"""Fall of n ln(RSS), beyond one for each parameter, from which a suspect is refitted. Noise alone passes it in
1 to 2 of 100 probes (chi-square, one and two parameters); passing costs time and decides nothing."""

LEAST = 1e-3
"""Smallest share of a probe at which an effect is tried."""

AS_LIKELY = 2.0 * CERTAIN
"""Fall of n ln(RSS) by which one formula of an effect may promise less than another, and be begun as well."""

PLACES = 3
"""Most probes that go on of those that differ in a frequency alone: a straight line tells these apart."""

BURST_SHARE = 0.1
"""Share of an effect that is tried where a simulation with all of it bursts."""

SEEN = 1e-6
"""Share of the noise's variance below which a change cannot be told from rounding."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """An effect at the probe that points best towards the recordings.

    Parameters
    ----------
    effect : str
    at : mapping of parameter to value
        Where a fit begins.
    held : mapping of parameter to value
        Tried at this value and not fitted.
    sizes : mapping of parameter to float
        Natural sizes of those that may have either sign.
    gain : float
        Fall of n ln(RSS) that the straight line promises.
    grown : tuple of str
        Parameters that the effect is proportional to while it is small.
    own : float
        Share of the change's square that nothing else in the model makes as well.
    """

    effect: str
    at: Mapping[str, float]
    held: Mapping[str, float]
    sizes: Mapping[str, float]
    gain: float
    grown: tuple[str, ...] = ()
    own: float = 1.0


def promising(suspect: Suspect) -> bool:
    """Whether a suspect is worth a refit."""
    return suspect.gain > PROMISING + len(suspect.at)


def variants(group: Sequence[Suspect]) -> list[Suspect]:
    """The best probe of an effect, for each value of what is tried and not fitted, and for each formula that promises
    as much; all of what acts beyond a threshold, of which a straight line promises nothing.
    """
    found: dict[tuple[object, ...], Suspect] = {}
    for suspect in group:
        begun = suspect.at.items() if CATALOGUE[suspect.effect].sudden else ()
        likely = promising(suspect) and group[0].gain - suspect.gain < AS_LIKELY
        form = frozenset(suspect.at if likely else group[0].at)
        found.setdefault((form, *sorted(suspect.held.items()), *begun), suspect)
    return list(found.values())


def candidates(fit: JointFit, baseline: str) -> tuple[Effect, ...]:
    """Effects that can be seen in the session's experiments, and that its model does not have yet."""
    return tuple(
        effect
        for effect in CATALOGUE.values()
        if any(trial.experiment.shows(effect) for trial in fit.trials)
        and effect.id not in fit.model.held
        # a smooth force beside a listed effect would only mend that effect's formula
        and (effect.id != "unlisted" or not fit.model.free)
        and (effect.rig or baseline != "sdof")
        and (effect.id != "translation_coupling" or baseline == "decoupled")
        and effect.probes
    )


def scan(fit: JointFit, effects: Sequence[Effect], small: bool = False) -> list[list[Suspect]]:
    """Per effect its suspects, the most promising probe first; effects that change nothing are left out.

    Parameters
    ----------
    fit : JointFit
        With slopes.
    effects : sequence of Effect
    small : bool
        The fit leaves hardly more than noise: what is missing is small, and each effect is tried as small as that. A
        stiffness that turns a decay by a radian points nowhere, a hundredth of it points home.
    """
    clear = Cleared(fit)
    found: dict[str, list[Suspect]] = {}
    for suspect in side_by_side(lambda one: _suspect(fit, clear, *one, small), probes(fit, effects)):
        if suspect is not None:
            found.setdefault(suspect.effect, []).append(suspect)
    groups = [_few_places(CATALOGUE[name], sorted(some, key=lambda s: -s.gain)) for name, some in found.items()]
    return sorted(groups, key=lambda group: -group[0].gain)


def probes(fit: JointFit, effects: Sequence[Effect]) -> list[tuple[Effect, dict[str, float], dict[str, float]]]:
    """Every probe of some effects in a session's own units, at each value of what is tried and not fitted."""
    sizes, found = sizes_of(fit), []
    for effect in effects:
        probes = (*effect.probes, *(effect.rig_probes if fit.model.on_rig else ()))
        for probe, held in itertools.product(probes, held_at(effect, fit.model)):
            at = {name: p.value(sizes) if isinstance(p, Sized) else float(p) for name, p in probe.items()}
            at = {p.name: float(np.clip(at[p.name], p.lower, p.upper)) for p in effect.parameters if p.name in at}
            if all(np.isfinite(list(at.values()))):
                found.append((effect, at, held))
    return found


def _few_places(effect: Effect, suspects: Sequence[Suspect]) -> list[Suspect]:
    """Without all but the best of those that a rig's probes try at many frequencies."""
    many = {tuple(probe) for probe in effect.rig_probes}
    count: dict[tuple[str, ...], int] = {}
    kept = []
    for suspect in suspects:
        form = tuple(name for name in (p.name for p in effect.parameters) if name in suspect.at)
        count[form] = count.get(form, 0) + 1
        if form not in many or count[form] <= PLACES:
            kept.append(suspect)
    return kept


def held_at(effect: Effect, model: Model) -> list[dict[str, float]]:
    """All values of an effect that are tried and not fitted, together; they set a robot's axes apart, and a rig has
    one."""
    holds = {} if model.on_rig else effect.holds
    return [dict(zip(holds, values, strict=True)) for values in itertools.product(*holds.values())]


def _suspect(
    fit: JointFit, clear: Cleared, effect: Effect, at: dict[str, float], held: dict[str, float], small: bool
) -> Suspect | None:
    signed = [p for p in effect.amplitudes if p.name in at and p.lower < 0.0]
    points = [at]
    if signed:  # each on its own: their shares follow from the match
        points = [{**at, **{p.name: float(p.off or 0.0) for p in signed if p is not chosen}} for chosen in signed]
    columns = []
    for point in points:
        change, size = _change(fit, effect.id, {**point, **held}), 1.0
        if change is None and not effect.sudden:
            # a spring that softens until it has no stiffness left is none to be held against recordings
            size = BURST_SHARE
            change = _change(fit, effect.id, {**smaller(effect, point, size), **held})
        if change is None or float(change @ change) < SEEN * len(change):
            return None
        rms = float(np.sqrt(change @ change / len(change)))
        if small and rms > 1.0 and not effect.sudden:
            size = max(1.0 / rms, LEAST)
            change = _change(fit, effect.id, {**smaller(effect, point, size), **held})
            if change is None:
                return None
        columns.append(change / size)
    raw = np.column_stack(columns)
    gram, slope = clear(raw)
    # a direction that the baseline makes as well, and may, is rounding once it is cleared
    if np.any(np.diag(gram) < ROUNDING * float(np.min(clear.weights)) * np.sum(raw**2, axis=0)):
        return None
    gram[np.diag_indices_from(gram)] *= 1.0 + 1e-9
    shares = np.linalg.solve(gram, slope)
    if not signed:
        shares = np.maximum(shares, 0.0)
    fall = float(2.0 * shares @ slope - shares @ gram @ shares)
    gain = -fit.independent * float(np.log(max(1.0 - fall / fit.independent, 1e-12)))
    start = dict(at)
    if small and not signed and not effect.sudden:
        start = smaller(effect, at, float(np.clip(shares[0], LEAST, 1.0)))
    grown = [p for p in effect.parameters if p.name in at and _grows(effect, p)]
    if signed:
        start |= {
            p.name: float(np.clip(share * at[p.name], p.lower, p.upper))
            for p, share in zip(signed, shares, strict=True)
        }
    names = tuple(p.name for p in (*grown, *signed))
    natural = {p.name: abs(at[p.name]) for p in signed}
    if not effect.sizes.keys().isdisjoint(at):
        sizes = sizes_of(fit)
        natural |= {name: sized.value(sizes) for name, sized in effect.sizes.items() if name in at}
    own = float(np.max(np.diag(gram) / clear.size_of(raw)))
    return Suspect(effect.id, start, held, natural, gain, names, own)


def smaller(effect: Effect, at: Mapping[str, float], share: float) -> dict[str, float]:
    """The same effect at a share of its size: what switches it off moves there, an infinity by the reciprocal."""
    found = dict(at)
    for parameter in effect.parameters:
        name, off = parameter.name, parameter.off
        if name not in at or (name not in effect.grows if effect.grows else off is None):
            continue
        off = 0.0 if off is None else off
        value = off + share * (at[name] - off) if np.isfinite(off) else at[name] / share
        found[name] = float(np.clip(value, parameter.lower, parameter.upper))
    return found


def _grows(effect: Effect, parameter: Parameter) -> bool:
    if effect.grows:
        return parameter.name in effect.grows
    return parameter.off == 0.0 and parameter.lower >= 0.0


def _change(fit: JointFit, effect_id: str, parameters: dict[str, float]) -> Array | None:
    """Whitened difference that an effect makes at the fit's own point and nuisances, all trials in a row."""
    values, effects = fit.model.split(fit.point)
    active = {**effects, effect_id: CATALOGUE[effect_id].begun(parameters)}

    def one(index: int) -> Array:
        trial = fit.trials[index]
        return trial.whitened(trial.run(values, active, fit.nuisances[index]) - fit.simulated[index])

    change = np.concatenate(over(fit.trials, one))
    return change if np.all(np.isfinite(change)) else None
