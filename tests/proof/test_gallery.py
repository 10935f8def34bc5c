"""Pictures of a proof."""

import numpy as np
import pytest

from ssmr_ident.compare.outcome import Prediction
from ssmr_proof.page.gallery import _drawn, _overlapping


def _from(first: int) -> Prediction:
    time = np.arange(first, 2000) / 1000.0
    wave = np.sin(20.0 * time)[:, None]
    return Prediction(time, ("ay",), ("m/s^2",), wave, 0.9 * wave)


def test_models_whose_sensors_settle_at_different_samples_are_drawn_together():
    before, after = _overlapping(_from(20), _from(21))
    assert before.time == pytest.approx(after.time)
    assert before.time[[0, -1]] == pytest.approx([0.021, 1.999])
    assert before.measured == pytest.approx(after.measured)
    top = _drawn(before, after).axes[0]
    assert [len(line.get_xdata()) for line in top.lines] == [1200, 1200, 1200]
