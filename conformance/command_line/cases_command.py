"""`pantocheck cases`: list of the library."""

from collections import Counter

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.command_line.console import build_table, console, escape_text
from pantocheck.conformance.input_files.trust import LEVELS


def cases_command() -> None:
    """List the cases of the library with the number and the trust of their limits.

    Example: pantocheck cases
    """
    table = build_table("case", "title", "limits", unbroken=("case", "limits"))
    for path in list_library(library_folder()).values():
        case = load_case(path)
        table.add_row(escape_text(case.id), escape_text(case.file.title), _count_limits(case))
    console().print(table)


def _count_limits(case: Case) -> str:
    counts = Counter(limit.trust for limit in case.limits)
    return ", ".join(f"{counts[level]} {level}" for level in LEVELS if counts[level]) or "none"
