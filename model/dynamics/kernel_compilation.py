"""Functions of a time step that numba compiles when they are first needed: the readable form of the core in C.

These functions allocate no memory, so that numba need not count references to their arrays. Counting them takes half of
the time of a step: a line has a hundred arrays, and every function that receives them counts each one up and down.
Without counting, numba refuses to compile a function that allocates an array.

Numba is loaded by the first call of an entry, which compiles it and all that it calls; other functions that Python
calls run as Python. A simulation with the core in C never loads it.
"""

from collections.abc import Callable
from functools import cached_property, partial, update_wrapper
from importlib import import_module
from types import FunctionType
from typing import Any, TypeVar

from pantocheck.model.dynamics.core_choice import UnusableCore, call_core, choose_core, pack_argument
from pantocheck.model.kernel_cache import drop_outdated_kernels, provide_kernel_cache

Function = TypeVar("Function", bound=Callable[..., Any])

NEVER_CALLED = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of a compiled function that only compiled functions call: it needs no code that unpacks objects of Python."""


class LateObject:
    """Object of numba that does not exist before it is needed; a compiled function names it like the object itself."""

    def __init__(self, build: Callable[[], Any]) -> None:
        self._build = build

    @cached_property
    def built(self) -> Any:
        """The object; builds it."""
        provide_kernel_cache()
        drop_outdated_kernels()
        import_module("pantocheck.model.dynamics.vector_code")  # the type of vectors, before a function is compiled
        return self._build()

    @property
    def _numba_type_(self) -> Any:
        return import_module("numba.core.registry").cpu_target.typing_context.resolve_value_type(self.built)

    def __getattr__(self, name: str) -> Any:
        """Options of the object, which numba reads when it compiles a caller."""
        if name.startswith("__") or name == "built":
            raise AttributeError(name)
        return getattr(self.built, name)


class EntryKernel(LateObject):
    """Function that Python calls: it runs in the chosen core, in C under its own name or compiled by numba."""

    __wrapped__: FunctionType

    def __call__(self, *arguments: Any) -> Any:
        """Run the function in the chosen core."""
        core, function = choose_core(), self.__wrapped__
        if not core.is_compiled:
            raise UnusableCore(f"the reference kernel is demanded, but {function.__name__} has fast kernels only")
        if (library := core.library) is None:
            return self.built(*arguments)
        result = call_core(library, function.__name__, arguments)
        return int(result) if function.__annotations__["return"] is int else result


class InnerKernel(LateObject):
    """Function that numba compiles for its callers; called from Python, it runs as Python."""

    __wrapped__: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        """Run the function in Python."""
        return self.__wrapped__(*arguments)


def bind_arrays(entry: Callable[..., Any], *first: Any) -> Callable[..., Any]:
    """Function of the other arguments of an entry kernel; the core in C receives the first ones packed once.

    The arrays of the first arguments must live as long as the function is called.
    """
    return partial(entry, *first if choose_core().library is None else map(pack_argument, first))


def _late(kind: type[EntryKernel] | type[InnerKernel], function: Function, **options: Any) -> Any:
    late = kind(lambda: import_module("numba").njit(cache=True, _nrt=False, **options)(function))
    return update_wrapper(late, function)


def kernel(function: Function) -> Function:
    """Compile a function of a time step for its callers, and keep it for other processes."""
    compiled: Function = _late(InnerKernel, function, **NEVER_CALLED)
    return compiled


def entry_kernel(function: Function) -> Function:
    """Compile a function that Python calls, or run its twin of the core in C; other threads of Python run meanwhile."""
    compiled: Function = _late(EntryKernel, function, nogil=True)
    return compiled


def inline_kernel(function: Function) -> Function:
    """Compile a function of a time step as part of its callers.

    For functions of vectors, and for those that receive all arrays of a line: a call would copy their descriptions.
    """
    compiled: Function = _late(InnerKernel, function, **NEVER_CALLED, forceinline=True)
    return compiled


def merged_kernel(function: Function) -> Function:
    """Compile a function of a time step as statements of its only caller.

    It is not compiled by itself then, which saves time in the first run after an installation.
    """
    compiled: Function = _late(InnerKernel, function, **NEVER_CALLED, inline="always")
    return compiled


def merged_entry_kernel(function: Function) -> Function:
    """Compile a function as statements of its only caller; called from Python, it runs in the chosen core."""
    compiled: Function = _late(EntryKernel, function, inline="always")
    return compiled
