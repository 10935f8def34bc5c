"""Lane after lane: for what branches by itself, or asks a library."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import overload

from ssmr_ident.core.simd.vector import INDEX, LANES, NUMBERS, WIDTH, LanesType, instructions


@instructions
def lane(typingctx: Any, x: Any, index: Any) -> Any:
    """One number out of ``Lanes``."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], builder.trunc(args[1], INDEX))

    return types.float64(LANES, types.intp), codegen


@instructions
def lane_of_all(typingctx: Any, numbers: Any, index: Any) -> Any:
    """One number out of each of a tuple's ``Lanes``."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place, found = builder.trunc(args[1], INDEX), []
        for at, kind in enumerate(numbers.types):
            one = builder.extract_value(args[0], at)
            if isinstance(kind, LanesType):
                found.append(builder.extract_element(one, place))
            else:
                found.append(context.cast(builder, one, kind, types.float64))
        return context.make_tuple(builder, sig.return_type, found)

    return types.UniTuple(types.float64, len(numbers))(numbers, types.intp), codegen


@instructions
def with_lane(typingctx: Any, x: Any, index: Any, value: Any) -> Any:
    """The same ``Lanes`` with one number changed."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], builder.trunc(args[1], INDEX))

    return LANES(LANES, types.intp, types.float64), codegen


@instructions
def nothing(typingctx: Any) -> Any:
    """``Lanes`` of zeros."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(NUMBERS, [0.0] * WIDTH)

    return LANES(), codegen


def lanewise(function: Callable[..., float]) -> Callable[..., float]:
    """A compiled function of numbers as one of ``Lanes`` too, lane after lane.

    For what branches by itself, or asks a library for its exponentials.
    """

    def in_lanes(*args: Any) -> Any:
        out = nothing()
        for i in range(WIDTH):
            out = with_lane(out, i, function(*lane_of_all(args, i)))
        return out

    def alone(*args: Any) -> Any:
        return function(*args)

    @functools.wraps(function)
    def either(*args: float) -> float:
        return function(*args)

    @overload(either, strict=False)
    def chosen(*args: Any) -> Any:
        return in_lanes if any(isinstance(a, LanesType) for a in args) else alone

    return either


def _by_library(function: Callable[[float], float]) -> None:
    def one_by_one(x: Any) -> Any:
        out = nothing()
        for i in range(WIDTH):
            out = with_lane(out, i, function(lane(x, i)))
        return out

    @overload(function, strict=False)
    def lanes(x: Any) -> Any:
        return one_by_one if isinstance(x, LanesType) else None


for _function in (math.sin, math.cos, math.exp, math.tanh):
    _by_library(_function)
