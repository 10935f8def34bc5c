"""Springs from forces: in series, in parallel, and which law a curve follows (3.8), (3.9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


def in_series(*springs: float) -> float:
    """Stiffness of springs in series [N/m] (3.9).

    >>> in_series(2.0, 2.0)
    1.0
    """
    return 1.0 / sum(1.0 / spring for spring in springs)


def behind_cable(measured: float, cable: float) -> float:
    """Tire stiffness behind a cable, K = K_m·K_c/(K_c − K_m) (3.9) [N/m].

    Raises
    ------
    ValueError
        When the cable alone is softer than what was measured.
    """
    if measured >= cable:
        raise ValueError(f"measured {measured:.4g} N/m is not below the cable's {cable:.4g} N/m")
    return measured * cable / (cable - measured)


def belt_stiffness(measured: float) -> float:
    """One of two belts in parallel, K_measured = 2·K_belt (3.8) [N/m].

    >>> belt_stiffness(6000.0)
    3000.0
    """
    return measured / 2.0


@dataclass(frozen=True)
class StiffnessLaw:
    """One law fitted to force over deflection.

    Parameters
    ----------
    name : str
        ``linear``, ``two slopes`` or ``cubic``.
    values, stds : dict of str to float
        In SI: force_zero [N], stiffness [N/m], and knee [m], stiffness_2 [N/m], or k3 [N/m^3].
    evidence : float
        Schwarz's criterion, less is better.
    scatter : float [N]
    """

    name: str
    values: dict[str, float]
    stds: dict[str, float]
    evidence: float
    scatter: float


@dataclass(frozen=True)
class StiffnessChoice:
    """Laws compared; the first has the best evidence.

    Parameters
    ----------
    laws : tuple of StiffnessLaw
        Best first.
    """

    laws: tuple[StiffnessLaw, ...]

    @property
    def best(self) -> StiffnessLaw:
        return self.laws[0]

    @property
    def decisive(self) -> bool:
        """True where the next law is worse by more than 10 (posterior odds of 150 to 1)."""
        return len(self.laws) < 2 or self.laws[1].evidence - self.laws[0].evidence > 10

    def __str__(self) -> str:
        lines = ["law            Schwarz   parameters"]
        for law in self.laws:
            values = ", ".join(f"{key} {value:.4g} ± {law.stds[key]:.2g}" for key, value in law.values.items())
            lines.append(f"{law.name:<12} {law.evidence - self.best.evidence:>9.1f}   {values}")
        return "\n".join(lines)


def compare_laws(deflection: Array, force: Array) -> StiffnessChoice:
    """One straight line, two joined lines, or a cubic: which law a stretch of force over deflection follows.

    Parameters
    ----------
    deflection : (n,) float [m]
    force : (n,) float [N]

    Notes
    -----
    Neighbouring samples go together, so the evidence counts n·(1 − r)/(1 + r) of them, r being the
    first-order correlation of the best law's residual.
    """
    deflection, force = np.asarray(deflection, float), np.asarray(force, float)
    offset = deflection - deflection[0]
    ones = np.ones(len(offset))
    fits: dict[str, tuple[tuple[Array, Array, float, Array], tuple[str, ...], int, float | None]] = {
        "linear": (_solve(np.column_stack([ones, offset]), force), ("force_zero", "stiffness"), 2, None),
        "cubic": (
            _solve(np.column_stack([ones, offset, offset**3]), force),
            ("force_zero", "stiffness", "k3"),
            3,
            None,
        ),
    }
    knees = np.linspace(offset.min(), offset.max(), 62)[3:-3]
    trials = [_solve(_bent(offset, knee), force) for knee in knees]
    pick = int(np.argmin([trial[2] for trial in trials]))
    fine = np.linspace(knees[max(pick - 1, 0)], knees[min(pick + 1, len(knees) - 1)], 21)
    trials = [_solve(_bent(offset, knee), force) for knee in fine]
    pick = int(np.argmin([trial[2] for trial in trials]))
    fits["two slopes"] = (trials[pick], ("force_zero", "stiffness", "change"), 4, float(fine[pick]))
    least = min(fits.values(), key=lambda fit: fit[0][2])[0]
    residual = least[3]
    power = float(residual @ residual)
    correlation = float(np.clip(residual[1:] @ residual[:-1] / power, 0.0, 0.95)) if power > 0 else 0.0
    effective = max(len(force) * (1 - correlation) / (1 + correlation), 8.0)
    laws = []
    for name, ((solution, spread, rss, _), keys, parameters, knee) in fits.items():
        values = dict(zip(keys, map(float, solution), strict=True))
        widened = np.sqrt((1 + correlation) / (1 - correlation))
        stds = dict(zip(keys, map(float, np.sqrt(np.diag(spread)) * widened), strict=True))
        if knee is not None:
            change = values.pop("change")
            stds.pop("change")
            values |= {"stiffness_2": values["stiffness"] + change, "knee": knee}
            both = spread[1, 1] + spread[2, 2] + 2 * spread[1, 2]
            scatter = np.sqrt(rss / max(len(force) - 4, 1))
            # Two lines that cross at an angle `change`, each known to about the std of its level.
            level_std = scatter / np.sqrt(effective / 2)
            stds |= {
                "stiffness_2": float(np.sqrt(both) * widened),
                "knee": float(level_std / max(abs(change), 1e-12)),
            }
        evidence = effective * np.log(max(rss, 1e-300) / len(force)) + parameters * np.log(effective)
        laws.append(
            StiffnessLaw(name, values, stds, float(evidence), float(np.sqrt(rss / max(len(force) - parameters, 1))))
        )
    return StiffnessChoice(tuple(sorted(laws, key=lambda law: law.evidence)))


def _bent(offset: Array, knee: float) -> Array:
    return np.column_stack([np.ones(len(offset)), offset, np.maximum(offset - knee, 0.0)])


def _solve(columns: Array, target: Array) -> tuple[Array, Array, float, Array]:
    """Least squares: solution, covariance, sum of squares, residual."""
    scale = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    scaled = columns / scale
    solution = np.linalg.lstsq(scaled, target, rcond=None)[0]
    residual = target - scaled @ solution
    rss = float(residual @ residual)
    variance = rss / max(len(target) - columns.shape[1], 1)
    spread = np.linalg.pinv(scaled.T @ scaled, hermitian=True) * variance / np.outer(scale, scale)
    return solution / scale, spread, rss, residual
