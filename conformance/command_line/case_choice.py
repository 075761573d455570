"""Choice of a single case by its id or path."""

from collections.abc import Callable

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.input_files.input_error import InputError


def choose_case(name: str, accept: Callable[[Case], bool], kind: str) -> Case:
    """Find the only case of a kind.

    Parameters
    ----------
    name : str
        Id, glob or path.
    accept : callable
        Condition on a case.
    kind : str
        Condition in words, for the message.

    Raises
    ------
    InputError
        No case, or several cases, meet the condition.
    """
    cases = [case for case in select_cases([name]) if accept(case)]
    if len(cases) != 1:
        ids = ", ".join(case.id for case in cases) or "none"
        raise InputError(f"case '{name}'", f"expected one case {kind}, found {ids}", "Give the id of one case.")
    return cases[0]
