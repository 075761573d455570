"""Requirement of a core of the time steps before a long computation, and notice of its compilation."""

import logging

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, UnusableCore, choose_core
from pantocheck.model.kernel_cache import has_kept_kernels

_LOGGER = logging.getLogger(__name__)

COMPILATION = "compiling the simulator, once, about 35 s"
"""Step of the first run after an installation; its processor time on the machine of the speed page is 33 s."""


def require_core(where: str) -> None:
    """Require a core of the time steps, which needs no compilation by this call.

    Args:
        where: Function, option or system that needs it.

    Raises:
        InputError: There is no core: no library of the core in C, and no extra `simulator`; or not the demanded one.
    """
    with refuse_missing_package(where):
        try:
            choose_core()
        except UnusableCore as error:
            raise InputError(where, str(error), f"Unset {CORE_VARIABLE}, or install the suite again.") from None


def needs_compilation() -> bool:
    """Whether the next time steps compile their kernels first."""
    core = choose_core()
    return core.library is None and core.is_compiled and not has_kept_kernels()


def announce_compilation() -> bool:
    """Warn if the next time steps compile their kernels first; whether they do."""
    if compiles := needs_compilation():
        _LOGGER.warning("%s", COMPILATION)
    return compiles
