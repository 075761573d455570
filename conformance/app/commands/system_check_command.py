"""`pantocheck system check`: the adapter of a simulator, with short cases."""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text
from pantocheck.conformance.app.self_test.adapter_check import AdapterCheck, check_adapter
from pantocheck.conformance.runs.command_system import parse_command

ADAPTER_TIMEOUT_S = 600.0
"""Default time limit of the short case [s], that of a case of `run`."""


def system_check_command(
    command: Annotated[str, typer.Argument(help="Program and arguments in quotes, as after `command:` of `run`.")],
    timeout: Annotated[float, typer.Option(help="Time limit of each short case [s].")] = ADAPTER_TIMEOUT_S,
) -> CommandOutput:
    """Check the adapter of a simulator with short cases.

    The program is started, receives a case of a few seconds, and its record is checked. The output names all that is
    missing or wrong, and lays the values beside those of the reference simulator. Two further messages are the line at
    rest and the case with two pantographs; the program may refuse them. Exit code 0: nothing is missing or
    wrong. Exit code 1: something is missing or wrong. Exit code 2: the program does not exist.

    Example: pantocheck system check 'python3 adapter.py'
    """
    system = parse_command(command.removeprefix("command:"), Path.cwd(), timeout)
    check = check_adapter(system)
    gaps = sum(finding.state in ("missing", "wrong") for finding in check.findings)
    text = "Nothing is missing." if check.passed else f"{gaps} of {len(check.findings)} findings need a correction."
    started = f"{system.name} {system.version} started and answered."
    return CommandOutput(
        Text(text),
        asdict(check),
        [*([escape_text(started)] if system.start_failure is None else []), *_build_tables(check)],
        exit_code=0 if check.passed else 1,
    )


def _build_tables(check: AdapterCheck) -> Iterator[RenderableType]:
    findings = ((finding.state, finding.subject, escape_text(finding.text)) for finding in check.findings)
    yield build_table("", "subject", "finding", unbroken=("", "subject"), rows=findings)
    if check.values:
        numbers = ("adapter", "reference", "difference")
        values = (
            (value.name, f"{value.value:.4g}", f"{value.reference:.4g}", f"{value.difference:+.1%}")
            for value in check.values
        )
        yield build_table("quantity", *numbers, right=numbers, rows=values)
