"""Numbers as the engine's XML takes them: to the last bit."""

from __future__ import annotations

import numpy as np


def text(value: float) -> str:
    return repr(float(value))


def row(values: np.ndarray) -> str:
    return " ".join(text(value) for value in values)


def six(tensor: np.ndarray) -> np.ndarray:
    return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]])
