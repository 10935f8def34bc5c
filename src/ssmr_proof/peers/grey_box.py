"""A plain grey box: output error by least squares, then the usual tests of the residual."""

from __future__ import annotations

import time

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2

from ssmr_ident.experiments.campaign import Campaign
from ssmr_ident.physics.rig import Rig, rig_from_parameters
from ssmr_ident.simulate.rig import simulate_rig
from ssmr_proof.peers.answer import PeerAnswer, drive_and_motion

LAGS = 25
LEVEL = 0.01
_COLUMN = {"position": 0, "velocity": 1, "acceleration": 2}


def grey_box(campaign: Campaign) -> PeerAnswer:
    """Mass, damper and spring with start, force zero and sensor zero per recording; no priors.

    The tests are those of every textbook (L. Ljung, System Identification, 1999, section 16.6): autocorrelation of
    the residual over 25 lags and its correlation with the input, each at 1 % over all recordings together. They say
    that something is missing, not what.
    """
    begin = time.perf_counter()
    quantity, targets = drive_and_motion(campaign)
    told = rig_from_parameters(campaign.parameters)
    bandwidth = campaign.parameters.number("accelerometer.bandwidth_hz", float("inf"))
    scale = np.array([told.mass, told.damping, told.stiffness])
    forces = [m.recording["force"] for m in targets]
    outputs = [m.recording[quantity] for m in targets]
    rates = [m.recording.sample_rate for m in targets]

    def motion(p: np.ndarray, index: int, force: np.ndarray, start: tuple[float, float]) -> np.ndarray:
        rate = rates[index]
        limit = bandwidth if bandwidth < 0.5 * rate else float("inf")
        found = simulate_rig(Rig(*(p * scale)), force, rate, *start, bandwidth_hz=limit)
        return found[:, _COLUMN[quantity]]

    def residuals(p: np.ndarray) -> list[np.ndarray]:
        found = []
        for index, (force, output) in enumerate(zip(forces, outputs, strict=True)):
            quiet = np.zeros_like(force)
            columns = np.column_stack([
                motion(p, index, quiet, (1.0, 0.0)), motion(p, index, quiet, (0.0, 1.0)),
                motion(p, index, quiet + 1.0, (0.0, 0.0)), np.ones(len(force)),
            ])  # fmt: skip
            size = np.linalg.norm(columns, axis=0)
            rest = output - motion(p, index, force, (0.0, 0.0))
            found.append(rest - columns @ (np.linalg.lstsq(columns / size, rest, rcond=1e-8)[0] / size))
        return found

    lower = np.full(3, 1e-3)
    fit = least_squares(lambda p: np.concatenate(residuals(p)), np.ones(3), bounds=(lower, np.inf), diff_step=1e-6)
    rest = residuals(fit.x)
    spread = float(np.std(np.concatenate(rest)))
    covariance = np.linalg.inv(fit.jac.T @ fit.jac) * spread**2
    half = 1.959964 * np.sqrt(np.diag(covariance)) * scale
    claims = []
    if _p_white(rest) < LEVEL:
        claims.append("the residual is not white")
    if _p_independent(rest, forces) < LEVEL:
        claims.append("the residual depends on the input")
    names = ("mass_kg", "damping_N_s_m", "stiffness_N_m")
    parameters = {n: (float(v), float(h)) for n, v, h in zip(names, fit.x * scale, half, strict=True)}
    spent = time.perf_counter() - begin
    return PeerAnswer("least squares", tuple(claims), (), bool(claims), spent, parameters)


def _p_white(rest: list[np.ndarray]) -> float:
    """Ljung and Box's portmanteau, summed over recordings."""
    total = 0.0
    for r in rest:
        n = len(r)
        r = r - r.mean()
        correlations = np.array([r[k:] @ r[: n - k] for k in range(1, LAGS + 1)]) / (r @ r)
        total += n * (n + 2) * float(np.sum(correlations**2 / (n - np.arange(1, LAGS + 1))))
    return float(chi2.sf(total, LAGS * len(rest)))


def _p_independent(rest: list[np.ndarray], forces: list[np.ndarray]) -> float:
    """Correlation with past inputs; the input's own correlation is taken into account."""
    total = 0.0
    for r, u in zip(rest, forces, strict=True):
        n = len(r)
        past = np.column_stack([np.roll(u - u.mean(), k)[LAGS:] for k in range(LAGS + 1)])
        r = r[LAGS:] - r[LAGS:].mean()
        values, vectors = np.linalg.eigh(past.T @ past / n)
        kept = values > 1e-6 * values.max()
        score = vectors[:, kept].T @ (past.T @ r) / np.sqrt(n)
        total += float(np.sum(score**2 / values[kept])) / float(r.var())
        if not kept.all():
            total += float(np.sum(~kept))  # directions that the input never takes say nothing
    return float(chi2.sf(total, (LAGS + 1) * len(rest)))
