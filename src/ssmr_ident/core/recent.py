"""Things that were made last, by what they were made of."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Generic, TypeVar

T = TypeVar("T")


class Same:
    """A key that stands for one object, however many are equal to it; the object is not changed while it is one."""

    __slots__ = ("it",)

    def __init__(self, it: object) -> None:
        self.it = it

    def __hash__(self) -> int:
        return id(self.it)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self.it is other.it


class Recent(Generic[T]):
    """Keeps the last few of what it was asked for, for all threads.

    Parameters
    ----------
    most : int
        How many.
    """

    def __init__(self, most: int = 256) -> None:
        self._most, self._kept = most, OrderedDict[Hashable, T]()

    def of(self, key: Hashable, make: Callable[[], T]) -> T:
        """What the key stands for, made where it is not there."""
        found = self._kept.get(key)
        if found is None:
            found = self._kept[key] = make()
            if len(self._kept) > self._most:
                with suppress(KeyError):  # another thread may have been first
                    self._kept.popitem(last=False)
        return found
