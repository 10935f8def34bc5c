"""A descent by plain squares, against an optimiser that shares no code with it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from small_rigs import Run, campaign, prepared

from ssmr_ident.identify.fitting.descent import descend
from ssmr_ident.identify.fitting.joint import evaluate


@pytest.mark.parametrize("temper", [1.0, 300.0])
def test_plain_squares_end_where_another_optimiser_ends(temper: float) -> None:
    made = campaign({"nonlinear_stiffness": {"k3_N_m3": 3e8}}, [Run(force=20.0), Run(force=60.0)], seed=4)
    setup = prepared(made)
    begun = [trial.begin({}, {}) for trial in setup.fitted]
    start = evaluate(setup.fitted, setup.model, np.zeros(len(setup.model.physics)), begun)
    fit = descend(start, 20, settled=1e-6, plain=True, temper=temper)

    def squares(x: np.ndarray) -> np.ndarray:
        cuts = np.cumsum([len(start.point), *(len(own) for own in begun)])[:-1]
        point, *nuisances = np.split(x, cuts)
        left = evaluate(start.trials, start.model, point, nuisances).residuals
        return np.concatenate([*(r / temper**0.5 for r in left), x])

    free = least_squares(squares, np.concatenate([start.point, *begun]), xtol=1e-10, ftol=1e-12)
    assert fit.rss > 10.0 * fit.size  # what is missing is large
    assert fit.rss / temper + fit.penalty == pytest.approx(2.0 * free.cost, rel=1e-4)
    assert fit.point == pytest.approx(free.x[: len(fit.point)], abs=0.01)
    assert not np.allclose(descend(start, 20, settled=1e-6).point, fit.point, atol=0.01)
