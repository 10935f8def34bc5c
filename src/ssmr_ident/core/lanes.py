"""Eight numbers at once in a compiled loop: where a kernel's text asks for a number, it may be given ``Lanes``.

numba compiles a kernel anew for every type of argument. ``Lanes`` is such a type: a vector of the processor's, with the
arithmetic of a number, lane by lane and to the last bit the same. Two things a text that is meant for both does in
another way than usual: it chooses by ``where`` and not by ``if``, and asks ``first`` for what all lanes have in common.
Machines without vectors of that width take two or four for one; nothing else changes.
"""

from __future__ import annotations

import functools
import inspect
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import typeconv
from numba.core.typing.templates import AbstractTemplate, ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, overload, register_model

WIDTH = 8

_NUMBERS = ir.VectorType(ir.DoubleType(), WIDTH)
_BITS = ir.VectorType(ir.IntType(64), WIDTH)
_CHOICES = ir.VectorType(ir.IntType(1), WIDTH)
_INDEX = ir.IntType(32)


class LanesType(types.Type):
    """A number in each lane."""

    def __init__(self) -> None:
        super().__init__("Lanes")

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Any:
        return typeconv.Conversion.safe if isinstance(other, types.Float | types.Integer) else None

    def unify(self, typingctx: Any, other: types.Type) -> types.Type | None:
        return self if isinstance(other, types.Float | types.Integer) else None


class MaskType(types.Type):
    """Yes or no in each lane."""

    def __init__(self) -> None:
        super().__init__("Mask")

    def can_convert_from(self, typingctx: Any, other: types.Type) -> Any:
        return typeconv.Conversion.safe if isinstance(other, types.Boolean) else None

    def unify(self, typingctx: Any, other: types.Type) -> types.Type | None:
        return self if isinstance(other, types.Boolean) else None


class LaneArrayType(types.Type):
    """Rows of lanes somewhere in memory, which whoever made them keeps; ``columns`` 0 is one index alone."""

    def __init__(self, columns: int) -> None:
        self.columns = columns
        super().__init__(f"LaneArray({columns})")


LANES, MASK = LanesType(), MaskType()
_instructions: Callable[..., Any] = intrinsic
_of_literals: Callable[..., Any] = intrinsic(prefer_literal=True)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, _NUMBERS)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, _BITS)


@register_model(LaneArrayType)
class _LaneArrayModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, ir.PointerType(ir.DoubleType()))


def _spread(builder: Any, value: Any, vector: Any) -> Any:
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, _INDEX(0))
    return builder.shuffle_vector(
        one, ir.Constant(vector, ir.Undefined), ir.Constant(ir.VectorType(_INDEX, WIDTH), [0] * WIDTH)
    )


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
def _from_number(context: Any, builder: Any, fromty: types.Type, toty: types.Type, value: Any) -> Any:
    return _spread(builder, context.cast(builder, value, fromty, types.float64), _NUMBERS)


@lower_cast(types.Boolean, MaskType)
def _from_choice(context: Any, builder: Any, fromty: types.Type, toty: types.Type, value: Any) -> Any:
    return _spread(builder, builder.zext(context.cast(builder, value, fromty, types.boolean), ir.IntType(64)), _BITS)


def _truth(builder: Any, mask: Any) -> Any:
    return builder.trunc(mask, _CHOICES)


def _arithmetic(symbol: Any, instruction: str) -> None:
    class Template(ConcreteTemplate):
        cases = [signature(LANES, LANES, LANES)]

    infer_global(symbol)(Template)

    @lower_builtin(symbol, LanesType, LanesType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)


def _comparison(symbol: Any, sign: str, unequal: bool) -> None:
    class Template(ConcreteTemplate):
        cases = [signature(MASK, LANES, LANES)]

    infer_global(symbol)(Template)

    @lower_builtin(symbol, LanesType, LanesType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        compare = builder.fcmp_unordered if unequal else builder.fcmp_ordered
        return builder.zext(compare(sign, *args), _BITS)


def _logic(symbol: Any, instruction: str) -> None:
    class Template(ConcreteTemplate):
        cases = [signature(MASK, MASK, MASK)]

    infer_global(symbol)(Template)

    @lower_builtin(symbol, MaskType, MaskType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args)


for _symbol, _name in (("add", "fadd"), ("sub", "fsub"), ("mul", "fmul"), ("truediv", "fdiv")):
    _arithmetic(getattr(operator, _symbol), _name)
    _arithmetic(getattr(operator, f"i{_symbol}"), _name)
for _symbol, _sign in (("lt", "<"), ("le", "<="), ("gt", ">"), ("ge", ">="), ("eq", "=="), ("ne", "!=")):
    _comparison(getattr(operator, _symbol), _sign, _symbol == "ne")
for _symbol in ("and_", "or_", "iand", "ior"):
    _logic(getattr(operator, _symbol), _symbol.removeprefix("i").removesuffix("_") + "_")


@infer_global(operator.neg)
class _Negative(ConcreteTemplate):
    cases = [signature(LANES, LANES)]


@lower_builtin(operator.neg, LanesType)
def _negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


def _one_instruction(function: Callable[..., Any], name: str, *others: type) -> None:
    @_instructions
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


@_instructions
def _select(typingctx: Any, mask: Any, yes: Any, no: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(_truth(builder, args[0]), args[1], args[2])

    return LANES(MASK, LANES, LANES), codegen


@_instructions
def lane(typingctx: Any, x: Any, index: Any) -> Any:
    """One number out of ``Lanes``; a number is the same in all of them."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if not isinstance(sig.args[0], LanesType):
            return args[0]
        return builder.extract_element(args[0], builder.trunc(args[1], _INDEX))

    if isinstance(x, LanesType):
        return types.float64(LANES, types.intp), codegen
    return types.float64(types.float64, types.intp), codegen


@_instructions
def with_lane(typingctx: Any, x: Any, index: Any, value: Any) -> Any:
    """The same ``Lanes`` with one number changed."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.insert_element(args[0], args[2], builder.trunc(args[1], _INDEX))

    return LANES(LANES, types.intp, types.float64), codegen


@_instructions
def _scale(typingctx: Any, n: Any) -> Any:
    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        whole = _BITS if isinstance(sig.args[0], LanesType) else ir.IntType(64)
        bias, up = (ir.Constant(whole, [v] * WIDTH if whole is _BITS else v) for v in (1023, 52))
        exponent = builder.shl(builder.add(builder.fptosi(args[0], whole), bias), up)
        return builder.bitcast(exponent, args[0].type)

    return (LANES(LANES) if isinstance(n, LanesType) else types.float64(types.float64)), codegen


def power_of_two(n: float) -> float:
    """2 to the power of a whole number between -1022 and 1023."""
    return math.ldexp(1.0, int(n))


@overload(power_of_two, strict=False)
def _power_of_two(n: Any) -> Any:
    return lambda n: _scale(n)


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


@_instructions
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


def lanewise(function: Callable[..., float]) -> Callable[..., float]:
    """A compiled function of numbers as one of ``Lanes`` too, lane after lane.

    For what branches by itself, or asks a library for its exponentials.
    """
    names = tuple(inspect.signature(function).parameters)
    takes, each = ", ".join(names), ", ".join(f"lane({name}, i)" for name in names)
    # numba asks what stands in for a function for the very arguments of it
    text = f"""
def in_lanes({takes}):
    out = nothing()
    for i in range({WIDTH}):
        out = with_lane(out, i, function({each}))
    return out

def alone({takes}):
    return function({takes})
"""
    known: dict[str, Any] = {"function": function, "lane": lane, "with_lane": with_lane, "nothing": nothing}
    exec(text, known)

    @functools.wraps(function)
    def either(*args: float) -> float:
        return function(*args)

    @overload(either, strict=False)
    def chosen(*args: Any) -> Any:
        return known["in_lanes" if any(isinstance(a, LanesType) for a in args) else "alone"]

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


@_instructions
def nothing(typingctx: Any) -> Any:
    """``Lanes`` of zeros."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(_NUMBERS, [0.0] * WIDTH)

    return LANES(), codegen


@_of_literals
def lanes_of(typingctx: Any, array: Any, columns: Any) -> Any:
    """What an array holds whose last axis is of lanes: by one index where ``columns`` is 0, else by row and column.

    Whoever has the array keeps it as long as it is used.
    """
    if not (isinstance(array, types.Array) and array.layout == "C" and isinstance(columns, types.IntegerLiteral)):
        return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return LaneArrayType(columns.literal_value)(array, columns), codegen


@_of_literals
def space(typingctx: Any, like: Any, rows: Any, columns: Any) -> Any:
    """Zeros, (rows, columns), that last until the kernel returns: of lanes where ``like`` is, else an array."""
    if not (isinstance(rows, types.IntegerLiteral) and isinstance(columns, types.IntegerLiteral)):
        return None
    size = rows.literal_value, columns.literal_value
    if not isinstance(like, LaneArrayType):

        def zeros(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return context.compile_internal(builder, lambda: np.zeros(size), sig.return_type(), [])

        return types.Array(types.float64, 2, "C")(like, rows, columns), zeros

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        with builder.goto_entry_block():
            whole = builder.alloca(_NUMBERS, size[0] * size[1])
        for place in range(size[0] * size[1]):
            at = builder.gep(whole, [_INDEX(place)], inbounds=True)
            builder.store(ir.Constant(_NUMBERS, [0.0] * WIDTH), at, align=8)
        return builder.bitcast(whole, ir.PointerType(ir.DoubleType()))

    return LaneArrayType(size[1])(like, rows, columns), codegen


def _at(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    array, kind = sig.args[:2]
    if array.columns:
        row, column = (
            context.cast(builder, builder.extract_value(args[1], place), each, types.intp)
            for place, each in enumerate(kind.types)
        )
        index = builder.add(builder.mul(row, row.type(array.columns)), column)
    else:
        index = context.cast(builder, args[1], kind, types.intp)
    place = builder.gep(args[0], [builder.mul(index, index.type(WIDTH))], inbounds=True)
    return builder.bitcast(place, ir.PointerType(_NUMBERS))


def _indexes(array: LaneArrayType, index: types.Type) -> bool:
    if array.columns:
        return isinstance(index, types.BaseTuple) and len(index) == 2
    return isinstance(index, types.Integer)


@infer_global(operator.getitem)
class _Item(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        if len(args) == 2 and isinstance(args[0], LaneArrayType) and _indexes(*args):
            return signature(LANES, *args)
        return None


@lower_builtin(operator.getitem, LaneArrayType, types.Any)
def _item(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(_at(context, builder, sig, args), align=8)


@infer_global(operator.setitem)
class _SetItem(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        if len(args) == 3 and isinstance(args[0], LaneArrayType) and _indexes(*args[:2]):
            return signature(types.none, args[0], args[1], LANES)
        return None


@lower_builtin(operator.setitem, LaneArrayType, types.Any, LanesType)
def _set_item(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    builder.store(args[2], _at(context, builder, sig, args), align=8)
    return context.get_dummy_value()
