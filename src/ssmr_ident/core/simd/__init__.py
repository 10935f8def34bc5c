"""Eight numbers at once in a compiled loop: where a kernel's text asks for a number, it may be given ``Lanes``.

numba compiles a kernel anew for every type of argument. ``Lanes`` is such a type: a vector of the processor's, with the
arithmetic of a number, lane by lane and to the last bit the same. Two things a text that is meant for both does in
another way than usual: it chooses by ``where`` and not by ``if``, and asks ``first`` for what all lanes have in common.
Machines without vectors of that width take two or four for one; nothing else changes. Why: decision 16.
"""

from __future__ import annotations

from ssmr_ident.core.simd.arithmetic import floor, power_of_two
from ssmr_ident.core.simd.choice import anywhere, first, where
from ssmr_ident.core.simd.each import lane, lanewise
from ssmr_ident.core.simd.rows import gathered, lanes_of, space
from ssmr_ident.core.simd.vector import WIDTH

__all__ = [
    "WIDTH",
    "anywhere",
    "first",
    "floor",
    "gathered",
    "lane",
    "lanes_of",
    "lanewise",
    "power_of_two",
    "space",
    "where",
]
