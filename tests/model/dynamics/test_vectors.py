"""Vectors of eight numbers: every operation against numpy."""

from collections.abc import Callable

import numpy as np
import pytest
from numba import njit

from helpers.lines import Array
from pantocheck.model.dynamics.vectors import (
    ALIGNMENT,
    LANES,
    align,
    lane_sum,
    load,
    round_up,
    shift_down,
    shift_up,
    splat,
    store,
    transpose,
)


def operate(a: Array, out: Array) -> float:
    """Every operation once; `a` holds eight vectors, and the results lie one after the other."""
    v = transpose(load(a, 0), load(a, 8), load(a, 16), load(a, 24), load(a, 32), load(a, 40), load(a, 48), load(a, 56))
    for i in range(LANES):
        store(out, LANES * i, v[i])
    first, second = load(a, 3), load(a, 20)
    store(out, 64, first + second)
    store(out, 72, first - second)
    store(out, 80, first * second)
    store(out, 88, splat(a[5]))
    store(out, 96, shift_up(first, second))
    store(out, 104, shift_down(first, second))
    return lane_sum(first)


@pytest.mark.parametrize("run", [operate, njit(operate)], ids=["in Python", "compiled"])
def test_every_operation_equals_numpy(run: Callable[[Array, Array], float]) -> None:
    """Whole numbers, so that no result is rounded; loads at any index."""
    a, out = np.random.default_rng(0).integers(-99, 99, 64).astype(np.float64), np.zeros(112)
    total = run(a, out)
    first, second = a[3:11], a[20:28]
    expected = [a.reshape(8, 8).T.ravel(), first + second, first - second, first * second, np.full(8, a[5])]
    expected += [np.append(second[-1], first[:-1]), np.append(first[1:], second[0])]
    np.testing.assert_array_equal(out, np.concatenate(expected))
    assert total == first.sum()


@pytest.mark.parametrize("shape", [(0,), (3,), (2, 5, 7)])
def test_aligned_copy_is_equal_and_aligned(shape: tuple[int, ...]) -> None:
    array = np.random.default_rng(1).normal(size=shape)
    aligned = align(array)
    np.testing.assert_array_equal(aligned, array)
    assert aligned.ctypes.data % ALIGNMENT == 0 or array.size == 0
    assert aligned.flags.c_contiguous
    assert not np.shares_memory(aligned, array)


def test_sizes_round_up_to_whole_vectors() -> None:
    assert [round_up(n) for n in (0, 1, 8, 9)] == [0, 8, 8, 16]
