"""Pieces side by side: in their order, one by one within each other, and errors reach who asked."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from ssmr_ident.identify import parallel
from ssmr_ident.identify.parallel import side_by_side


@pytest.fixture(params=[1, 2, 5])
def workers(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch):
    with ThreadPoolExecutor(request.param) as pool:
        monkeypatch.setattr(parallel, "_WORKERS", request.param)
        monkeypatch.setattr(parallel, "_POOL", pool)
        yield request.param


def test_results_come_in_the_order_of_what_was_asked(workers: int) -> None:
    first_may_go = threading.Event()

    def slow_at_first(item: int) -> int:
        if workers > 1 and item == 0:
            assert first_may_go.wait(10.0)
        if item == 1:
            first_may_go.set()
        return item * item

    assert list(side_by_side(slow_at_first, range(6))) == [0, 1, 4, 9, 16, 25]


def test_what_is_asked_from_within_waits_for_no_worker(workers: int) -> None:
    def row(size: int) -> tuple[list[str], str]:
        return list(
            side_by_side(lambda _: threading.current_thread().name, range(size))
        ), threading.current_thread().name

    for names, own in side_by_side(row, [3] * 20):
        assert set(names) == {own}


def test_an_error_reaches_who_asked_and_leaves_the_pool_as_it_was(workers: int) -> None:
    with pytest.raises(ZeroDivisionError):
        list(side_by_side(lambda item: 1 / item, [1, 0, 2]))
    assert list(side_by_side(abs, [-1, -2])) == [1, 2]
