"""What stands in for ``if``: lanes choose each for itself."""

from __future__ import annotations

import math
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import overload

from ssmr_ident.core.simd.each import lane
from ssmr_ident.core.simd.vector import LANES, MASK, WIDTH, LanesType, MaskType, instructions

_CHOICES = ir.VectorType(ir.IntType(1), WIDTH)


def _truth(builder: Any, mask: Any) -> Any:
    return builder.trunc(mask, _CHOICES)


@instructions
def _select(typingctx: Any, mask: Any, yes: Any, no: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(_truth(builder, args[0]), args[1], args[2])

    return LANES(MASK, LANES, LANES), codegen


def where(mask: Any, yes: Any, no: Any) -> Any:
    """``yes`` where the mask says so, ``no`` elsewhere; both are worked out."""
    return yes if mask else no


@overload(where, strict=False)
def _where(mask: Any, yes: Any, no: Any) -> Any:
    if isinstance(mask, MaskType):
        return lambda mask, yes, no: _select(mask, yes, no)
    if isinstance(mask, types.Boolean):
        return lambda mask, yes, no: yes if mask else no
    return None


@instructions
def _any_bit(typingctx: Any, mask: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bits = builder.bitcast(_truth(builder, args[0]), ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", bits, ir.IntType(WIDTH)(0))

    return types.boolean(MASK), codegen


def anywhere(mask: Any) -> bool:
    """Whether the mask says yes in any lane."""
    return bool(mask)


@overload(anywhere, strict=False)
def _anywhere(mask: Any) -> Any:
    return (lambda mask: _any_bit(mask)) if isinstance(mask, MaskType) else (lambda mask: mask)


def first(x: Any) -> float:
    """The number that all lanes have in common."""
    return float(x)


@overload(first, strict=False)
def _first(x: Any) -> Any:
    return (lambda x: lane(x, 0)) if isinstance(x, LanesType) else (lambda x: x)


@overload(max, strict=False)
def _max(a: Any, b: Any) -> Any:
    if isinstance(a, LanesType) or isinstance(b, LanesType):
        return lambda a, b: where(a >= b, a, b)
    return None


@overload(min, strict=False)
def _min(a: Any, b: Any) -> Any:
    if isinstance(a, LanesType) or isinstance(b, LanesType):
        return lambda a, b: where(a <= b, a, b)
    return None


@overload(math.isfinite, strict=False)
def _isfinite(x: Any) -> Any:
    return (lambda x: abs(x) < math.inf) if isinstance(x, LanesType) else None
