"""Option `--cases`, completion and selection of cases, without the imports of a run."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.line.library_folder import library_folder


def complete_case(incomplete: str) -> list[str]:
    """Ids of the library that begin with the typed text; the shell completes paths of case files."""
    return [name for name in list_library(library_folder()) if name.startswith(incomplete)]


CasesOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--cases",
        metavar="DIR",
        help="Folder with further cases, whose ids begin with own/; repeat the option for several.",
    ),
]


def leave_out_required(pattern: str, cases: list[Case]) -> list[Case]:
    """Cases that the pattern selects itself, without the cases that they require."""
    exact = [case for case in cases if case.id == pattern]
    required = {name for case in cases for name in case.file.requires}
    return exact or [case for case in cases if case.id not in required] or cases
