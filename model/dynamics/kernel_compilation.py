"""Decorators of the compiled functions of a time step.

These functions allocate no memory, so that numba need not count references to their arrays. Counting them takes half of
the time of a step: a line has a hundred arrays, and every function that receives them counts each one up and down.
Without counting, numba refuses to compile a function that allocates an array.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numba

_njit: Any = numba.njit  # The type of some versions lists public options only.

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a function of a time step, and keep it for other processes; other threads of Python run meanwhile."""
    compiled: Function = _njit(cache=True, _nrt=False, nogil=True)(function)
    return compiled


def inline_kernel(function: Function) -> Function:
    """Compile a function of a time step as part of its callers.

    For functions of vectors, and for those that receive all arrays of a line: a call would copy their descriptions.
    """
    compiled: Function = _njit(cache=True, _nrt=False, forceinline=True)(function)
    return compiled


def merged_kernel(function: Function) -> Function:
    """Compile a function of a time step as statements of its only caller.

    It is not compiled by itself then, which saves time in the first run after an installation.
    """
    compiled: Function = _njit(cache=True, _nrt=False, inline="always")(function)
    return compiled
