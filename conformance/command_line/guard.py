"""What every command does with a wrong input, with a line that has no solution, and with Ctrl-C."""

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import typer

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.model.failures import SimulationError

BAD_INPUT = 2
INTERRUPTED = 130

P = ParamSpec("P")
R = TypeVar("R")


def guard_command(command: Callable[P, R]) -> Callable[P, R]:
    """The command, with an input error printed as its message (exit code 2) and Ctrl-C ending quietly (130).

    A line whose equations have no solution is an input error, too.
    """

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return command(*args, **kwargs)
        except InputError as error:
            typer.echo(strip_control_characters(str(error)), err=True)
            raise typer.Exit(BAD_INPUT) from None
        except SimulationError as error:
            typer.echo(strip_control_characters(f"{error}\n  Check the line's data."), err=True)
            raise typer.Exit(BAD_INPUT) from None
        except KeyboardInterrupt:
            typer.echo("Interrupted.", err=True)
            raise typer.Exit(INTERRUPTED) from None

    return run


def strip_control_characters(text: str) -> str:
    """Text of a stranger's file without the control characters that a terminal would obey."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)
