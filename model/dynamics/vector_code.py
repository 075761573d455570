"""Code that numba generates for the functions of `vectors`."""

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core.datamodel.models import PrimitiveModel
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, register_model

from pantocheck.model.dynamics.vectors import LANES

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INDEX = ir.IntType(32)
_MAY_FUSE = ("contract",)
_compiled: Any = intrinsic
"""Decorator of the functions of vectors, which exist in compiled kernels only."""


class Vector(types.Type):
    """Type of a vector in a compiled kernel."""

    def __init__(self) -> None:
        super().__init__(name="Vector8")


vector = Vector()


@register_model(Vector)
class VectorModel(PrimitiveModel):
    """A vector is one value of the compiler."""

    def __init__(self, manager: Any, vector_type: Any) -> None:
        super().__init__(manager, vector_type, _VECTOR)


def _define_operator(function: Any, instruction: str) -> None:
    """Let an operator of two vectors compile to one instruction."""

    class Typing(ConcreteTemplate):
        cases = (signature(vector, vector, vector),)

    infer_global(function)(Typing)

    @lower_builtin(function, vector, vector)
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, instruction)(*args, flags=_MAY_FUSE)


for _operator, _instruction in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul")):
    _define_operator(_operator, _instruction)


def _address(context: Any, builder: Any, array_type: Any, array: Any, at: Any) -> Any:
    """Address of eight numbers of an array."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _VECTOR.as_pointer())


def _shuffle(builder: Any, a: Any, b: Any, order: list[int]) -> Any:
    """Lanes of two vectors in another order; those of the second count from 8."""
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(_INDEX, LANES), order))


@_compiled
def load(typing: Any, array: Any, at: Any) -> Any:
    """Load eight numbers of an array from an index of the flattened array on."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_address(context, builder, sig.args[0], *args), align=8)

    return vector(array, types.intp), generate


@_compiled
def store(typing: Any, array: Any, at: Any, value: Any) -> Any:
    """Store eight numbers in an array from an index of the flattened array on."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, sig.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


@_compiled
def splat(typing: Any, x: Any) -> Any:
    """Fill a vector with one number."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        one = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), args[0], ir.Constant(_INDEX, 0))
        return _shuffle(builder, one, one, [0] * LANES)

    return vector(types.float64), generate


@_compiled
def shift_up(typing: Any, v: Any, before: Any) -> Any:
    """Move every lane up by one; the first one comes from the last lane of `before`."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _shuffle(builder, args[1], args[0], list(range(LANES - 1, 2 * LANES - 1)))

    return vector(vector, vector), generate


@_compiled
def shift_down(typing: Any, v: Any, after: Any) -> Any:
    """Move every lane down by one; the last one comes from the first lane of `after`."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _shuffle(builder, args[0], args[1], list(range(1, LANES + 1)))

    return vector(vector, vector), generate


@_compiled
def lane_sum(typing: Any, v: Any) -> Any:
    """Sum of the lanes, pair by pair."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        total = args[0]
        for distance in (4, 2, 1):
            other = _shuffle(builder, total, total, [lane ^ distance for lane in range(LANES)])
            total = builder.fadd(total, other)
        return builder.extract_element(total, ir.Constant(_INDEX, 0))

    return types.float64(vector), generate


@_compiled
def transpose(typing: Any, v0: Any, v1: Any, v2: Any, v3: Any, v4: Any, v5: Any, v6: Any, v7: Any) -> Any:
    """Transpose eight vectors: lane i of vector j becomes lane j of vector i."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        vectors = list(args)
        for width in (1, 2, 4):
            for i in range(LANES):
                if not i & width:
                    low = [j if not j & width else LANES + j - width for j in range(LANES)]
                    high = [j + width if not j & width else LANES + j for j in range(LANES)]
                    pair = vectors[i], vectors[i + width]
                    vectors[i], vectors[i + width] = (_shuffle(builder, *pair, order) for order in (low, high))
        return context.make_tuple(builder, sig.return_type, vectors)

    return types.UniTuple(vector, LANES)(*[vector] * LANES), generate
