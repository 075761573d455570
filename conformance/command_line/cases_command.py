"""`pantocheck cases`: list of the library and of cases from outside."""

from collections import Counter

import typer

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import CaseEntry, open_catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.command_line.cases_option import CasesOption
from pantocheck.conformance.command_line.console import build_table, console, escape_text
from pantocheck.conformance.command_line.guard import BAD_INPUT, strip_control_characters
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.trust import LEVELS


def cases_command(folders: CasesOption = None) -> None:
    """List the cases of the library, of folders and of installed distributions.

    Examples:

    pantocheck cases

    pantocheck cases --cases my-cases
    """
    catalogue = open_catalogue(folders or ())
    try:
        entries, problem = catalogue.every, None
    except InputError as error:  # a distribution with invalid cases does not hide the others
        entries, problem = catalogue.listed, error
    _print_cases(entries)
    if problem is not None:
        typer.echo(strip_control_characters(str(problem)), err=True)
        raise typer.Exit(BAD_INPUT)


def _print_cases(entries: dict[str, CaseEntry]) -> None:
    """Table of cases; a column names the source of those from outside, if there are any."""
    has_sources = any(entry.origin is not None for entry in entries.values())
    columns = ("case", "title", "limits", *(("source",) if has_sources else ()))
    table = build_table(*columns, unbroken=("case", "limits"))
    for entry in entries.values():
        case = load_entry(entry)
        source = "library" if entry.origin is None else entry.origin.text
        cells = (escape_text(case.id), escape_text(case.file.title), _count_limits(case), escape_text(source))
        table.add_row(*cells[: len(columns)])
    console().print(table)


def _count_limits(case: Case) -> str:
    counts = Counter(limit.trust for limit in case.limits)
    return ", ".join(f"{counts[level]} {level}" for level in LEVELS if counts[level]) or "none"
