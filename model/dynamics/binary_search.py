"""Binary search in a part of an array, without a view of this part."""

from pantocheck.model.arrays import Array, Indices
from pantocheck.model.dynamics.kernel_compilation import kernel


@kernel
def search(values: Array | Indices, first: int, end: int, value: float) -> int:
    """First index from `first` on, before `end`, of increasing values that is not below a value; else `end`."""
    while first < end:
        middle = (first + end) // 2
        if values[middle] < value:
            first = middle + 1
        else:
            end = middle
    return first
