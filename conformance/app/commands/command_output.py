"""Execution of a command and its output: conclusion and details for a reader, data for a program, files and log."""

import inspect
import json
import logging
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import typer
from pydantic import BaseModel
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.console import console, error_console, escape_text
from pantocheck.conformance.app.commands.guard import guard_command, strip_control_characters
from pantocheck.conformance.app.commands.output_settings import (
    FLAGS,
    Detail,
    add_flags,
    combine_flags,
    current_settings,
    list_given,
    use_settings,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.verdicts import WORST_FIRST, Verdict

OUTPUT_SCHEMA = "pantocheck.output/1"

EXIT_CODES: dict[Verdict, int] = {**dict.fromkeys(WORST_FIRST, 1), "pass": 0, "error": 2, "info": 3}
"""Exit code by verdict: 0 only for `pass`, 3 where no limit judges."""


class Unwrapped(Text):
    """Text to be copied, such as a path or a file: its lines stay whole on a narrow terminal."""


@dataclass(frozen=True)
class CommandOutput:
    """Output of a command."""

    conclusion: Text
    """Verdict or result in one line, which `-q` prints alone; empty: the details are the result."""
    data: object
    """Result for a program: a pydantic model, or plain lists, dictionaries, text and numbers."""
    details: Sequence[RenderableType] = ()
    """Text and tables below the conclusion."""
    further: Sequence[RenderableType] = ()
    """Text and tables that only `-v` prints."""
    files: Sequence[Path] = field(default=())
    """Written files."""
    exit_code: int = 0
    """Exit code of the command."""
    remarks: Sequence[str] = ()
    """Remarks on the files, which go to standard error."""

    def list_parts(self, detail: Detail) -> list[RenderableType]:
        """Text and tables in their order, without the files."""
        if detail == "quiet":
            return [self.conclusion] if self.conclusion else [*self.details]
        further = self.further if detail == "verbose" else ()
        return [*filter(None, [self.conclusion]), *self.details, *further]


def print_output(output: CommandOutput, command: str) -> None:
    """Print the output of a command in the form and amount of the current settings."""
    settings = current_settings()
    for remark in () if settings.detail == "quiet" else output.remarks:
        error_console().print(escape_text(f"remark: {remark}"), soft_wrap=True)  # holds a command to be copied
    if settings.form == "json":
        files = [str(path) for path in output.files]
        facts = {"conclusion": output.conclusion.plain, "files": files, "result": output.data}
        _print_json(command, output.exit_code, facts)
        return
    parts = output.list_parts(settings.detail)
    if settings.detail != "quiet":
        parts += [Unwrapped(escape_text(str(path)).plain) for path in output.files]
    printed = console()
    for part in parts:
        printed.print(part, soft_wrap=isinstance(part, Unwrapped))


def print_failure(command: str, message: str, error: Exception | None, exit_code: int) -> None:
    """Print a failure as JSON, if the current settings ask for it; the message itself goes to standard error."""
    if current_settings().form == "json":
        problems = list_problems(error) if isinstance(error, InputError) else []
        _print_json(command, exit_code, {"conclusion": message, "files": [], "problems": problems})


def list_problems(error: InputError) -> list[dict[str, str]]:
    """Problems of an input for a program."""
    return [{"where": problem.where, "found": problem.found, "hint": problem.hint} for problem in error.problems]


def _print_json(command: str, exit_code: int, facts: dict[str, object]) -> None:
    """Print one object in ASCII characters: control characters of foreign texts are escaped."""
    content = {"schema": OUTPUT_SCHEMA, "command": command, "exit_code": exit_code, **facts}
    sys.stdout.write(json.dumps(_make_plain(content), indent=1, allow_nan=False) + "\n")


def _make_plain(content: object) -> Any:
    """Content of plain JSON values: models as dictionaries, tuples as lists, numbers that are not finite as null."""
    if isinstance(content, BaseModel):
        return _make_plain(content.model_dump(mode="json", by_alias=True))
    if isinstance(content, dict):
        return {str(key): _make_plain(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [_make_plain(value) for value in content]
    if isinstance(content, float):
        return content if math.isfinite(content) else None
    return content if content is None or isinstance(content, (bool, int, str)) else str(content)


# Remarks of a run: those of several cases are footnotes, printed once; others are warnings of their case.
STANDING_REMARKS = ("20-50 Hz: lumped models",)
"""First words of remarks that hold for every run and that a user cannot act on."""


# Log of a command on standard error: records of the loggers `pantocheck.*`, with `--verbose`.
ROOT_LOGGER = "pantocheck"


class _ErrorLog(logging.Handler):
    """Handler that prints above a line of progress, if there is one."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record without control characters."""
        errors = error_console()
        # Outside of a terminal a line stays whole, for a search in a log.
        errors.print(Text(strip_control_characters(self.format(record))), soft_wrap=not errors.is_terminal)


@contextmanager
def print_log() -> Iterator[None]:
    """Print the log while a command runs, if the current settings ask for details."""
    if current_settings().detail != "verbose":
        yield
        return
    logger, handler = logging.getLogger(ROOT_LOGGER), _ErrorLog(logging.INFO)
    handler.setFormatter(logging.Formatter("%(asctime)s %(name)s: %(message)s", "%H:%M:%S"))
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(min(logging.INFO, level or logging.INFO))
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)


# Execution of a command.
def build_executable(name: str, command: Callable[..., CommandOutput]) -> Callable[..., None]:
    """Function for typer that runs a command, prints its output and ends with its exit code.

    It has the parameters of the command and the options of the output, which count before the command, too.
    """

    def run(context: typer.Context, **arguments: object) -> None:
        given = {flag: bool(arguments.pop(flag)) for flag in FLAGS}
        with use_settings(combine_flags(context.obj | list_given(given))):
            raise typer.Exit(guard_command(execute, partial(print_failure, name))(**arguments))

    def execute(**arguments: object) -> int:
        with print_log():
            output = command(**arguments)
        print_output(output, name)
        return output.exit_code

    own = inspect.signature(run).parameters["context"]
    parameters = [own, *inspect.signature(command, eval_str=True).parameters.values()]
    parameters = [parameter.replace(kind=parameter.KEYWORD_ONLY) for parameter in parameters]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__doc__ = command.__doc__
    return add_flags(run, "hidden")
