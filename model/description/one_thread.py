"""Linear algebra in one thread.

On matrices of a few hundred unknowns, the threads of a linear algebra library wait for each other most of the time, on
a loaded machine nearly all of it.
"""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def use_one_thread(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let linear algebra inside a function use one thread; afterwards the number of threads is as before."""

    @wraps(function)
    def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return run
