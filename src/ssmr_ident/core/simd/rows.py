"""Lanes in memory: the arrays of a caller, and room that a kernel takes for itself."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, overload

from ssmr_ident.core.simd.vector import (
    BITS,
    INDEX,
    LANES,
    NUMBERS,
    WIDTH,
    LaneArrayType,
    LanesType,
    instructions,
    of_literals,
    spread,
)


@of_literals
def lanes_of(typingctx: Any, array: Any, columns: Any) -> Any:
    """What an array holds whose last axis is of lanes: by one index where ``columns`` is 0, else by row and column.

    Whoever has the array keeps it as long as it is used.
    """
    if not (isinstance(array, types.Array) and array.layout == "C" and isinstance(columns, types.IntegerLiteral)):
        return None

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return LaneArrayType(columns.literal_value)(array, columns), codegen


@of_literals
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
            whole = builder.alloca(NUMBERS, size[0] * size[1])
        for place in range(size[0] * size[1]):
            at = builder.gep(whole, [INDEX(place)], inbounds=True)
            builder.store(ir.Constant(NUMBERS, [0.0] * WIDTH), at, align=8)
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
    return builder.bitcast(place, ir.PointerType(NUMBERS))


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


@instructions
def _gathered(typingctx: Any, table: Any, index: Any) -> Any:
    pointers = ir.VectorType(ir.PointerType(ir.DoubleType()), WIDTH)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        first = builder.ptrtoint(data, ir.IntType(64))
        offset = builder.shl(builder.fptosi(args[1], BITS), ir.Constant(BITS, [3] * WIDTH))
        places = builder.inttoptr(builder.add(spread(builder, first, BITS), offset), pointers)
        mask, nought = ir.VectorType(ir.IntType(1), WIDTH), ir.Constant(NUMBERS, [0.0] * WIDTH)
        called = ir.FunctionType(NUMBERS, [pointers, ir.IntType(32), mask, NUMBERS])
        gather = builder.module.declare_intrinsic(f"llvm.masked.gather.v{WIDTH}f64.v{WIDTH}p0", (), called)
        return builder.call(gather, [places, ir.IntType(32)(8), ir.Constant(mask, [1] * WIDTH), nought])

    return LANES(table, LANES), codegen


def gathered(table: Any, index: Any) -> Any:
    """Numbers of a one-dimensional table at whole numbers, which are in it."""
    return table[int(index)]


@overload(gathered, strict=False)
def _gathered_or_read(table: Any, index: Any) -> Any:
    if isinstance(index, LanesType):
        return lambda table, index: _gathered(table, index)
    return lambda table, index: table[int(index)]
