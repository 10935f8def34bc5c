"""Stages of a diagnosis, for a progress bar."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]


class Counter:
    """How much of one stage is done; never more than all of it, and all of it at its end."""

    def __init__(self, show: Progress, stage: str, total: int) -> None:
        self.show, self.stage, self.total, self.done = show, stage, total, 0
        show(stage, 0, total)

    def advance(self) -> None:
        self.done = min(self.done + 1, self.total)
        self.show(self.stage, self.done, self.total)

    def finish(self) -> None:
        self.show(self.stage, self.total, self.total)
