"""What numbers in lanes do with each other: one instruction each."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import lower_builtin, overload

from ssmr_ident.core.simd.vector import BITS, LANES, MASK, WIDTH, LanesType, instructions


def _operation(symbol: Any, of: types.Type, instruction: str) -> None:
    class Template(ConcreteTemplate):
        cases = [signature(of, of, of)]

    infer_global(symbol)(Template)

    @lower_builtin(symbol, type(of), type(of))
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)


def _comparison(symbol: Any, sign: str, unequal: bool) -> None:
    class Template(ConcreteTemplate):
        cases = [signature(MASK, LANES, LANES)]

    infer_global(symbol)(Template)

    @lower_builtin(symbol, LanesType, LanesType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        compare = builder.fcmp_unordered if unequal else builder.fcmp_ordered
        return builder.zext(compare(sign, *args), BITS)


for _symbol, _name in (("add", "fadd"), ("sub", "fsub"), ("mul", "fmul"), ("truediv", "fdiv")):
    _operation(getattr(operator, _symbol), LANES, _name)
    _operation(getattr(operator, f"i{_symbol}"), LANES, _name)
for _symbol, _sign in (("lt", "<"), ("le", "<="), ("gt", ">"), ("ge", ">="), ("eq", "=="), ("ne", "!=")):
    _comparison(getattr(operator, _symbol), _sign, _symbol == "ne")
for _symbol in ("and_", "or_", "iand", "ior"):
    _operation(getattr(operator, _symbol), MASK, _symbol.removeprefix("i").removesuffix("_") + "_")


@infer_global(operator.neg)
class _Negative(ConcreteTemplate):
    cases = [signature(LANES, LANES)]


@lower_builtin(operator.neg, LanesType)
def _negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


def _one_instruction(function: Callable[..., Any], name: str, *others: type) -> None:
    @instructions
    def applied(typingctx: Any, x: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            kind = f"{name}.v{WIDTH}f64" if isinstance(x, LanesType) else f"{name}.f64"
            called = ir.FunctionType(args[0].type, [args[0].type])
            return builder.call(builder.module.declare_intrinsic(kind, (), called), args)

        return x(x), codegen

    @overload(function, strict=False)
    def lanes(x: Any) -> Any:
        return (lambda x: applied(x)) if isinstance(x, (LanesType, *others)) else None


def floor(x: float) -> float:
    """The whole number below."""
    return float(math.floor(x))


_one_instruction(abs, "llvm.fabs")
_one_instruction(floor, "llvm.floor", types.Float)
_one_instruction(math.sqrt, "llvm.sqrt")


@instructions
def _scale(typingctx: Any, n: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        whole = BITS if isinstance(sig.args[0], LanesType) else ir.IntType(64)
        bias, up = (ir.Constant(whole, [v] * WIDTH if whole is BITS else v) for v in (1023, 52))
        exponent = builder.shl(builder.add(builder.fptosi(args[0], whole), bias), up)
        return builder.bitcast(exponent, args[0].type)

    return (LANES(LANES) if isinstance(n, LanesType) else types.float64(types.float64)), codegen


def power_of_two(n: float) -> float:
    """2 to the power of a whole number between -1022 and 1023."""
    return math.ldexp(1.0, int(n))


@overload(power_of_two, strict=False)
def _power_of_two(n: Any) -> Any:
    return lambda n: _scale(n)
