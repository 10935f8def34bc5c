"""Numbers as text, without exponents that other programs stumble over."""

from __future__ import annotations

import numpy as np


def fixed(values: np.ndarray, decimals: int, mark: str = ".") -> list[str]:
    """Numbers with a fixed count of decimals; NaN stays ``NaN``.

    >>> fixed(np.array([0.1, np.nan]), 3, ",")
    ['0,100', 'NaN']
    """
    texts = [f"{value:.{decimals}f}" if np.isfinite(value) else "NaN" for value in values.tolist()]
    return texts if mark == "." else [text.replace(".", mark) for text in texts]


def shortest(values: np.ndarray) -> list[str]:
    """Numbers in the fewest digits that read back to the same double."""
    return [repr(value) if np.isfinite(value) else "NaN" for value in values.tolist()]
