"""`pantocheck cases`: list of the library and of cases from outside."""

from collections import Counter

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text
from pantocheck.conformance.app.commands.guard import BAD_INPUT, strip_control_characters
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import CaseEntry, open_catalogue
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.trust import LEVELS


def cases_command(folders: CasesOption = None) -> CommandOutput:
    """List the cases of library, folders and distributions.

    Examples:

    pantocheck cases

    pantocheck cases --cases my-cases
    """
    catalogue = open_catalogue(folders or ())
    try:
        entries, exit_code = catalogue.every, 0
    except InputError as error:  # a distribution with invalid cases does not hide the others
        entries, exit_code = catalogue.listed, BAD_INPUT
        typer.echo(strip_control_characters(str(error)), err=True)
    listed = [(entry, load_entry(entry)) for entry in entries.values()]
    data = [
        {
            "id": case.id,
            "title": case.file.title,
            "limits": _count_limits(case),
            "source": "library" if entry.origin is None else entry.origin.text,
        }
        for entry, case in listed
    ]
    return CommandOutput(Text(f"{len(data)} cases"), data, (_build_table(listed),), exit_code=exit_code)


def _build_table(listed: list[tuple[CaseEntry, Case]]) -> FittedTable:
    """Table of cases; a column names the source of those from outside, if there are any."""
    has_sources = any(entry.origin is not None for entry, _ in listed)
    columns = ("case", "title", "limits", *(("source",) if has_sources else ()))
    table = build_table(*columns, unbroken=("case",))
    for entry, case in listed:
        counts = ",\n".join(f"{count} {level}" for level, count in _count_limits(case).items())
        source = "library" if entry.origin is None else entry.origin.text
        cells = (escape_text(case.id), escape_text(case.file.title), counts or "none", escape_text(source))
        table.add_row(*cells[: len(columns)])
    return table


def _count_limits(case: Case) -> dict[str, int]:
    """Number of limits of a case by trust."""
    counts = Counter(limit.trust for limit in case.limits)
    return {level: counts[level] for level in LEVELS if counts[level]}
