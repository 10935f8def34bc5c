"""The types: numbers in lanes, answers in lanes, and rows of lanes in memory."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import typeconv
from numba.extending import intrinsic, lower_cast, models, register_model

WIDTH = 8

NUMBERS = ir.VectorType(ir.DoubleType(), WIDTH)
BITS = ir.VectorType(ir.IntType(64), WIDTH)
INDEX = ir.IntType(32)


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
instructions: Callable[..., Any] = intrinsic
of_literals: Callable[..., Any] = intrinsic(prefer_literal=True)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, NUMBERS)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, BITS)


@register_model(LaneArrayType)
class _LaneArrayModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: types.Type) -> None:
        super().__init__(dmm, fe_type, ir.PointerType(ir.DoubleType()))


def spread(builder: Any, value: Any, vector: Any) -> Any:
    """One value in every lane."""
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, INDEX(0))
    return builder.shuffle_vector(
        one, ir.Constant(vector, ir.Undefined), ir.Constant(ir.VectorType(INDEX, WIDTH), [0] * WIDTH)
    )


@lower_cast(types.Float, LanesType)
@lower_cast(types.Integer, LanesType)
def _from_number(context: Any, builder: Any, fromty: types.Type, toty: types.Type, value: Any) -> Any:
    return spread(builder, context.cast(builder, value, fromty, types.float64), NUMBERS)


@lower_cast(types.Boolean, MaskType)
def _from_choice(context: Any, builder: Any, fromty: types.Type, toty: types.Type, value: Any) -> Any:
    return spread(builder, builder.zext(context.cast(builder, value, fromty, types.boolean), ir.IntType(64)), BITS)
