"""Requirement of a core of the time steps before a long computation."""

from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.model.dynamics.core_choice import CORE_VARIABLE, UnusableCore, choose_core


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
