"""The robot's compiled loop for many runs at once: in lanes where they are alike, one after the other elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.simd import WIDTH, lane, lanes_of
from ssmr_ident.physics.sensor import low_pass_coefficients
from ssmr_ident.simulate.body import Body
from ssmr_ident.simulate.layout import OUTPUTS
from ssmr_ident.simulate.pulling import HELD, PULLED, PULLING
from ssmr_ident.simulate.robot_kernel import run

_COLUMNS = len(OUTPUTS)

STILL = np.zeros(PULLING)
"""Nothing pulls."""

FEWEST = 3
"""Runs from which lanes are quicker than one run after the other."""

LONGEST = 200_000
"""Samples up to which they are taken: eight runs of all outputs then fill 0.4 GB, and each thread has its own."""


@dataclass(frozen=True, eq=False)
class Run:
    """One run of the loop.

    Parameters
    ----------
    body : Body
    p : (PARAMETERS,) float
        Its parameters, with the wheels that grip.
    start : (START,) float
    pulling : (PULLING,) float
    head : (m,) float [m]
    """

    body: Body
    p: np.ndarray
    start: np.ndarray
    pulling: np.ndarray
    head: np.ndarray

    @property
    def beyond(self) -> bool:
        """Whether anything acts or pulls."""
        return self.body.beyond or bool(self.pulling[PULLED] > 0.5)

    @property
    def bandwidth_hz(self) -> float:
        """Of its accelerometer."""
        return self.body.robot.accelerometer.bandwidth_hz

    @property
    def alike(self) -> tuple[object, ...]:
        """What runs have in common that go in lanes; wheels that grip differ from lane to lane."""
        own = self.body.alike
        if self.pulling is STILL:
            return (own, len(self.head))
        return (own, len(self.head), self.pulling[PULLED], self.pulling[HELD])


def run_together(
    runs: Sequence[Run],
    head_step: float,
    reference: np.ndarray,
    reference_step: float,
    step: float,
    stride: int,
    samples: int,
    kept: np.ndarray,
) -> np.ndarray:
    """Integrate runs, to the last bit what each gives alone.

    Parameters
    ----------
    runs : sequence of Run
    head_step, reference, reference_step, step, stride
        As the loop takes them.
    samples : int
    kept : (c,) int
        Outputs that are wanted.

    Returns
    -------
    (k, samples, c) float
        NaN all through where a state was no longer finite.
    """
    out = np.empty((len(runs), samples, len(kept)))
    groups: dict[tuple[object, ...], list[int]] = {}
    for index, one in enumerate(runs):
        groups.setdefault(one.alike, []).append(index)
    for members in groups.values():
        own = [runs[index] for index in members]
        floors, begins = _floors(own)
        filters = {hertz: low_pass_coefficients(hertz, step) for hertz in {one.bandwidth_hz for one in own}}
        _in_turn(
            np.array([one.p for one in own]),
            np.array([one.body.e for one in own]),
            floors,
            begins,
            np.array([one.body.mast for one in own]),
            np.array([one.pulling for one in own]),
            np.array([one.head for one in own]),
            head_step,
            reference,
            reference_step,
            np.array([one.start for one in own]),
            np.array([filters[one.bandwidth_hz] for one in own]),
            np.array(members),
            step,
            (samples - 1) * stride,
            stride,
            True if own[0].beyond else None,
            kept,
            out,
        )
    return out


def _floors(runs: Sequence[Run]) -> tuple[np.ndarray | None, np.ndarray]:
    """Floors that runs have, each once and one behind the other, None where all are flat; and where each run's begins,
    (k, 1) float."""
    if runs[0].body.uneven is None:
        return None, np.zeros((len(runs), 1))
    different = {id(one.body.floor): one.body.floor for one in runs}
    lengths = np.cumsum([0, *(len(floor) for floor in different.values())])
    begins = dict(zip(different, lengths.tolist(), strict=False))
    return np.concatenate(list(different.values())), np.array([[float(begins[id(one.body.floor)])] for one in runs])


@kernel
def _in_turn(
    p, e, floors, begins, mast, pulling, head, head_step, reference, reference_step, start, low_pass, places, step,
    steps, stride, beyond, kept, out,
):  # fmt: skip
    """``run`` for every row of its arguments; results go to ``places`` of ``out``."""
    done = 0
    if out.shape[1] <= LONGEST:
        wide = np.empty((out.shape[1] if len(places) >= FEWEST else 0, _COLUMNS, WIDTH))
        while len(places) - done >= FEWEST:
            upto = min(done + WIDTH, len(places))
            ended = _in_lanes(
                _abreast(p, done, upto), _abreast(e, done, upto), floors, _abreast(begins, done, upto),
                _abreast(mast.reshape(len(mast), 64), done, upto), _abreast(pulling, done, upto),
                _abreast(head, done, upto), head.shape[1] - 1, head_step, reference, reference_step,
                _abreast(start, done, upto), step, steps, stride, _abreast(low_pass, done, upto), wide, beyond,
            )  # fmt: skip
            for j in range(upto - done):
                place = places[done + j]
                for n in range(out.shape[1]):
                    for c in range(len(kept)):
                        out[place, n, c] = wide[n, kept[c], j] if ended[j] < 0.0 else np.nan
            done = upto
    whole = np.empty((out.shape[1], _COLUMNS))
    for j in range(done, len(places)):
        place = places[j]
        ended_at = run(
            p[j], e[j], floors, begins[j, 0], mast[j], pulling[j], head[j], head.shape[1] - 1, head_step, reference,
            reference_step, start[j], step, steps, stride, low_pass[j], whole, beyond,
        )  # fmt: skip
        for n in range(out.shape[1]):
            for c in range(len(kept)):
                out[place, n, c] = whole[n, kept[c]] if ended_at < 0.0 else np.nan


@kernel
def _in_lanes(
    p, e, floors, begins, mast, pulling, head, head_last, head_step, reference, reference_step, start, step, steps,
    stride, low_pass, out, beyond,
):  # fmt: skip
    """``run`` for arrays whose last axis is of lanes; the caller keeps them. (WIDTH,) float, as ``run`` returns."""
    ended = run(
        lanes_of(p, 0), lanes_of(e, 0), floors, lanes_of(begins, 0)[0], lanes_of(mast, 8), lanes_of(pulling, 0),
        lanes_of(head, 0), head_last, head_step, reference, reference_step, lanes_of(start, 0), step, steps, stride,
        lanes_of(low_pass, 0), lanes_of(out, _COLUMNS), beyond,
    )  # fmt: skip
    failed = np.empty(WIDTH)
    for j in range(WIDTH):
        failed[j] = lane(ended, j)
    return failed


@kernel
def _abreast(rows, first, upto):
    """Rows (k, n) as lanes, (n, WIDTH); lanes that are left over do what the last one does."""
    out = np.empty((rows.shape[1], WIDTH))
    for j in range(WIDTH):
        out[:, j] = rows[min(first + j, upto - 1)]
    return out
