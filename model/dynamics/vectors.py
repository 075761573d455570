"""Vectors of eight numbers for compiled kernels: load, store, splat, + - *, shifts by a lane, sum, 8 x 8 transposition.

A kernel with vectors reads like its scalar form with eight stations (or eight pieces of line) at a time, the lanes:

    for s in range(first, end):                     for s in range(first, end, LANES):
        w[s] += x * column[s]                           store(w, s, load(w, s) + splat(x) * load(column, s))

The compiler divides a vector into the registers of the processor: one with AVX-512, two with AVX2. Addresses are those
of the flattened array and are not checked. Numba may fuse a product and a sum, so that they are rounded once.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

from pantocheck.model.description.arrays import Array
from pantocheck.model.dynamics.kernel_compilation import InnerKernel

LANES = 8
"""Numbers in a vector."""
ALIGNMENT = 64
"""Address of an aligned array: a multiple of the size of a vector and of a line of the cache [bytes]."""


def _vector(name: str, form: Callable[..., Any]) -> Any:
    """Function of vectors: `vector_code` in compiled kernels, and `form` on arrays of eight numbers in Python."""
    late = InnerKernel(lambda: getattr(import_module("pantocheck.model.dynamics.vector_code"), name))
    late.__wrapped__ = form
    return late


_FORMS: dict[str, Callable[..., Any]] = {
    "load": lambda array, at: array.reshape(-1)[at : at + LANES].copy(),
    "store": lambda array, at, v: np.copyto(array.reshape(-1)[at : at + LANES], v),
    "splat": lambda x: np.full(LANES, x),
    "shift_up": lambda v, before: np.append(before[-1], v[:-1]),
    "shift_down": lambda v, after: np.append(v[1:], after[0]),
    "lane_sum": lambda v: v.reshape(2, 2, 2).sum(0).sum(0).sum(0),
    "transpose": lambda *vectors: np.array(vectors).T,
}
load, store, splat, shift_up, shift_down, lane_sum, transpose = map(_vector, _FORMS, _FORMS.values())


def round_up(size: int, multiple: int = LANES) -> int:
    """Smallest multiple that is not below a size."""
    return -(-size // multiple) * multiple


def align(array: Array) -> Array:
    """Copy an array to an aligned address: a vector then lies in one line of the cache."""
    memory = np.empty(array.nbytes + ALIGNMENT, dtype=np.uint8)
    start = -memory.ctypes.data % ALIGNMENT
    aligned: Array = memory[start : start + array.nbytes].view(array.dtype).reshape(array.shape)
    aligned[...] = array
    return aligned
