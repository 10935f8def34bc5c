"""Pieces side by side: in their order, shared out by whoever has time, and errors reach who asked."""

from __future__ import annotations

import threading
import time
from contextvars import ContextVar

import pytest

from ssmr_ident.core import threads
from ssmr_ident.core.threads import Pool, side_by_side

SETTING: ContextVar[int] = ContextVar("setting", default=0)


@pytest.fixture(params=[1, 2, 5])
def workers(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    _with(int(request.param), monkeypatch)
    return int(request.param)


def _with(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    pool = Pool(workers)
    monkeypatch.setattr(threads, "_pool", lambda: pool)


def _who(_: object) -> str:
    time.sleep(0.01)
    return threading.current_thread().name


def test_results_come_in_the_order_of_what_was_asked(workers: int) -> None:
    first_may_go = threading.Event()

    def slow_at_first(item: int) -> int:
        if workers > 1 and item == 0:
            assert first_may_go.wait(10.0)
        if item == 1:
            first_may_go.set()
        return item * item

    assert list(side_by_side(slow_at_first, range(6))) == [0, 1, 4, 9, 16, 25]


def test_as_many_threads_work_as_there_are_workers(workers: int) -> None:
    together = threading.Barrier(workers)
    names = list(side_by_side(lambda _: (together.wait(10.0), _who(_))[1], range(workers)))
    assert len(set(names)) == workers


def test_what_is_asked_from_within_is_worked_off_however_deep(workers: int) -> None:
    def deep(level: int) -> int:
        return 1 if level == 0 else sum(side_by_side(deep, [level - 1] * 3))

    assert list(side_by_side(deep, [4] * 7)) == [81] * 7


def test_who_has_nothing_to_do_helps_with_what_is_asked_from_within(monkeypatch: pytest.MonkeyPatch) -> None:
    _with(2, monkeypatch)

    def long_or_short(long: bool) -> set[str]:
        if not long:
            return set()
        found: set[str] = set()
        for _ in range(50):  # the other thread has ended its item after the first of these at the latest
            found |= set(side_by_side(_who, range(4)))
        return found

    (names, _) = side_by_side(long_or_short, [True, False])
    assert len(names) == 2


def test_while_all_have_work_what_is_asked_from_within_stays_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    _with(2, monkeypatch)
    together = threading.Barrier(2)

    def own(_: int) -> bool:
        together.wait(10.0)
        names = set(side_by_side(_who, range(3)))
        together.wait(10.0)
        return names == {threading.current_thread().name}

    assert list(side_by_side(own, range(2))) == [True, True]


def test_what_nobody_wants_any_more_ends_where_it_asks_for_more(monkeypatch: pytest.MonkeyPatch) -> None:
    _with(2, monkeypatch)
    reader, begun, ended = threading.current_thread(), threading.Event(), threading.Event()

    def endless(item: int) -> None:
        if item == 0 or threading.current_thread() is reader:
            return
        begun.set()
        try:
            while True:
                list(side_by_side(_who, [item]))
        finally:
            ended.set()

    results = side_by_side(endless, range(50))
    next(results)
    assert begun.wait(10.0)
    results.close()  # type: ignore[attr-defined]
    assert ended.wait(10.0)


def test_an_error_reaches_who_asked_and_leaves_the_pool_as_it_was(workers: int) -> None:
    with pytest.raises(ZeroDivisionError):
        list(side_by_side(lambda item: 1 / item, [1, 0, 2]))
    with pytest.raises(ZeroDivisionError):
        list(side_by_side(lambda item: list(side_by_side(lambda other: 1 / other, [item, 1])), [2, 0]))
    assert list(side_by_side(abs, [-1, -2])) == [1, 2]


def test_results_that_nobody_waits_for_are_not_worked_out(monkeypatch: pytest.MonkeyPatch) -> None:
    _with(2, monkeypatch)
    begun: list[int] = []

    def one(item: int) -> str:
        begun.append(item)
        return _who(item)

    results = side_by_side(one, range(100))
    next(results)
    results.close()  # type: ignore[attr-defined]
    count = len(begun)
    time.sleep(0.05)
    assert count < 10
    assert len(begun) <= count + 1
    assert list(side_by_side(abs, [-1, -2])) == [1, 2]


def test_settings_of_who_asked_hold_in_every_thread(workers: int) -> None:
    SETTING.set(7)
    assert list(side_by_side(lambda _: (_who(_), SETTING.get())[1], range(8))) == [7] * 8
    SETTING.set(0)
