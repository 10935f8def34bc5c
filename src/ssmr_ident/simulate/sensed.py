"""What sensor effects make of the true channels."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ssmr_ident.physics.effect import Site
from ssmr_ident.physics.effects import CATALOGUE
from ssmr_ident.physics.slots import Effects


def sensed(time: np.ndarray, channels: Mapping[str, np.ndarray], active: Effects) -> dict[str, np.ndarray]:
    """Channels as the instrument gives them, effect by effect.

    Parameters
    ----------
    time : (n,) float [s]
    channels : mapping of name to (n,) float [SI]
    active : mapping of effect id to complete parameters

    Returns
    -------
    dict of name to (n,) float
    """
    result = dict(channels)
    for effect_id, values in active.items():
        change = CATALOGUE[effect_id].acts.get(Site.OUTPUT)
        if change and not CATALOGUE[effect_id].is_off(values):
            result = change(time, result, **values)
    return result
