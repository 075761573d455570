"""Option `--cases` and completion of cases, without the imports of a case."""

from pathlib import Path
from typing import Annotated

import typer


def complete_case(incomplete: str) -> list[str]:
    """Ids of the library that begin with the typed text; the shell completes paths of case files."""
    from pantocheck.conformance.cases.case_source import list_library
    from pantocheck.conformance.line.library_folder import library_folder

    return [name for name in list_library(library_folder()) if name.startswith(incomplete)]


CasesOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--cases",
        metavar="DIR",
        help="Folder with further cases, whose ids begin with own/; repeat the option for several.",
    ),
]
