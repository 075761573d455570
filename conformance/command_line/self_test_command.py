"""`pantocheck self-test`: systems that are wrong on purpose must not pass."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from pantocheck.conformance.self_test.bench import SelfTest


def self_test_command(
    case: Annotated[
        list[str] | None,
        typer.Argument(help="Ids of cases the reference simulator passes.  [default: 2002 model]"),
    ] = None,
    markdown: Annotated[Path | None, typer.Option(help="Markdown file to write the table to.")] = None,
) -> None:
    """Test the suite itself: the right system must pass, and every wrong one be caught for its reason.

    Example: pantocheck self-test --markdown self-test.md
    """
    from pantocheck.conformance.cases.library import select_cases
    from pantocheck.conformance.command_line.console import console, escape_text
    from pantocheck.conformance.input_files.atomic_writing import check_writable, write_atomically
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.self_test.bench import run_self_test
    from pantocheck.conformance.self_test.self_test_page import build_self_test_page

    cases = [one for one in select_cases(case or ["en50318-2002/250", "en50318-2002/300"]) if not one.is_static]
    if not cases:
        raise InputError("case", "none of these is a run", "Name cases with a train, e.g. en50318-2002/250.")
    if markdown is not None:
        check_writable(markdown.parent)
    output = console()
    with output.status("testing the suite") as status:
        done = run_self_test(cases, lambda name: status.update(f"testing the suite: {name}"))
    _print(done)
    if markdown is not None:
        write_atomically(markdown, build_self_test_page(done).encode())
        output.print(escape_text(str(markdown)), soft_wrap=True)
    raise typer.Exit(0 if done.passed else 1)


def _print(done: "SelfTest") -> None:
    from rich.table import Table

    from pantocheck.conformance.command_line.console import console, escape_text, style_verdict

    output = console()
    caught = sum(row.caught for row in done.rows)
    output.print(
        style_verdict("pass" if done.passed else "fail"),
        escape_text(f" {caught} of {len(done.rows)} mutants caught for the reason stated"),
    )
    for name, (verdict, reason) in done.right.items():
        output.print(escape_text(f"the right system on {name}:"), style_verdict(verdict), escape_text(reason))
    for title, rows in (("must be caught", done.rows), ("may pass", done.mild)):
        table = Table(title=title, box=None, header_style="dim", title_justify="left")
        for heading in ("mutant", "case", "verdict", "limits alone", "caught by", "what a user is told"):
            table.add_column(heading)
        for row in rows:
            by = row.mutant.caught_by or ", ".join(row.checks)
            table.add_row(
                escape_text(row.mutant.name),
                escape_text(row.case),
                style_verdict(row.verdict),
                style_verdict(row.by_limits),
                escape_text(by if row.caught else f"MISSED, expected {by}"),
                escape_text(row.reason[:160]),
            )
        output.print()
        output.print(table)
