"""Core of the time steps: the C file of this folder, compiled at the installation, or the kernels compiled by numba.

Both compute the same, to rounding. The core in C runs if the installation has its library, else that of numba. The
environment variable `PANTOCHECK_CORE` demands one of them, `c` or `numba`, or the slow `reference_kernel`.
"""

import ctypes
import os
import struct
from collections.abc import Callable, Sequence
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pantocheck.model.description.failures import SimulationError
from pantocheck.model.dynamics.core_source import SOURCES, source_digest

CORE_VARIABLE = "PANTOCHECK_CORE"
KERNELS = ("c", "numba", "reference")
"""Values of this variable."""


class UnusableCore(SimulationError):
    """The demanded core cannot run: another one must not run silently in its place."""


class Core(NamedTuple):
    """Core of the time steps."""

    name: str
    """Language and compiler, as results state them."""
    library: ctypes.CDLL | None
    """Library of the core in C; None: another core."""
    is_compiled: bool = True
    """Whether it is compiled; False: the reference kernel."""


REFERENCE_CORE = Core("reference (full matrices)", None, is_compiled=False)


def choose_core() -> Core:
    """Core that runs: the demanded one, else that in C, else that of numba.

    Raises:
        UnusableCore: The demanded core does not exist.
        ModuleNotFoundError: There is no core, because numba is not installed either.
    """
    demanded = os.environ.get(CORE_VARIABLE, "")
    if demanded not in {"", *KERNELS}:
        raise UnusableCore(f"{CORE_VARIABLE} is '{demanded}'; it must be 'c', 'numba' or 'reference'")
    if demanded == "reference":
        return REFERENCE_CORE
    core = find_core_in_c()
    if isinstance(core, Core) and demanded != "numba":
        return core
    if demanded == "c":
        raise UnusableCore(f"{CORE_VARIABLE} demands the core in C, but {core}")
    if find_spec("numba") is None:
        raise ModuleNotFoundError("No module named 'numba'", name="numba")
    return Core(f"numba {version('numba')}", None)


def core_name() -> str:
    """Name of the core that runs; `none` without one."""
    try:
        return choose_core().name
    except (ModuleNotFoundError, UnusableCore):
        return "none"


@cache
def find_core_in_c() -> Core | str:
    """Core in C of this installation, or the reason why there is none."""
    paths = (SOURCES[0].with_suffix(suffix) for suffix in EXTENSION_SUFFIXES)
    path = next((path for path in paths if path.is_file()), None)
    return "it was not compiled at the installation, for want of a C compiler" if path is None else load_core(path)


@cache
def load_core(path: Path) -> Core | str:
    """Core of a library, or the reason why it cannot run: it is of another source, or of another system."""
    try:
        library = ctypes.CDLL(str(path))
        source, compiler = (_read_text(library, name) for name in ("source", "compiler"))
    except (OSError, ValueError) as error:
        return f"its library cannot be loaded: {error}"
    if source != source_digest():
        return f"{path.name} was compiled from another source: install the suite again"
    return Core(f"C ({compiler})", library)


def _read_text(library: ctypes.CDLL, name: str) -> str:
    return str(ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(library, f"pantocheck_{name}"))), "ascii")


def call_core(library: ctypes.CDLL, name: str, arguments: Sequence[Any]) -> float:
    """Call a function of the core in C; other threads of Python run meanwhile.

    Args:
        library: Library of the core.
        name: Name of the function in Python.
        arguments: Its arguments; results are written to their arrays. Bytes: arguments that are packed already.

    Returns:
        Result of the function; zero if it has none.
    """
    function = getattr(library, f"pantocheck_{name.strip('_')}")
    function.argtypes, function.restype = [ctypes.c_char_p], ctypes.c_double
    words = b"".join(value if isinstance(value, bytes) else pack_argument(value) for value in arguments)
    result = float(function(struct.pack("=q", len(words) + 8) + words))
    if result < 0:
        raise UnusableCore(f"the core in C has other structures than the arguments of {name}")
    return result


def find_address(array: NDArray[Any]) -> int:
    """Address of an array in the memory of this process."""
    return int(array.ctypes.data)


def pack_argument(value: Any, kind: Any = None, locate: Callable[[NDArray[Any]], int] = find_address) -> bytes:
    """Pack an argument as the structures of the C file: an array as its address and four sizes, a number as a word.

    Args:
        value: Named tuple, array or number; the arrays must outlive the packed form.
        kind: Declared type of a number.
        locate: Function that gives the address of an array.

    Raises:
        TypeError: An array is not contiguous, or has another type of values than 64-bit numbers or truth values.
    """
    if isinstance(value, tuple):
        kinds = type(value).__annotations__
        return b"".join(pack_argument(part, kinds[name], locate) for name, part in zip(kinds, value, strict=True))
    if isinstance(value, np.ndarray):
        if not value.flags.c_contiguous or value.dtype not in (np.float64, np.int64, np.bool_):
            raise TypeError(
                f"an array of the core is contiguous, of 64-bit numbers; found {value.dtype} {value.strides}"
            )
        return struct.pack("=5q", locate(value), *value.shape, *[1] * (4 - value.ndim))
    real = kind is float or isinstance(value, float)
    return struct.pack("=d", value) if real else struct.pack("=q", value)
