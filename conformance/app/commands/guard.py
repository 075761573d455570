"""Error handling of all commands: every failure becomes a message and an exit code."""

import errno
import functools
import os
import traceback
from collections.abc import Callable
from typing import NoReturn, ParamSpec, TypeVar

import typer

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import interruption_exit_code
from pantocheck.model.description.failures import SimulationError

BAD_INPUT = 2
"""Exit code after wrong input, a failure of the model or an internal error."""

FULL = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EIO)
"""Errors of a device that takes no more output."""

TRACEBACK_VARIABLE = "PANTOCHECK_TRACEBACK"

P = ParamSpec("P")
R = TypeVar("R")


def guard_command(
    command: Callable[P, R], report: Callable[[str, Exception | None, int], None] = lambda *failure: None
) -> Callable[P, R]:
    """Wrap a command so that failures end with one message: no traceback reaches the user.

    Args:
        command: Function of a command.
        report: Also receives the message, the failure and the exit code.

    Returns:
        The same command. It ends with exit code 2 after an `InputError`, a `SimulationError` or an internal error, with
        130 after Ctrl-C, 143 after SIGTERM and 129 after SIGHUP. The traceback of an internal error is printed if
        `PANTOCHECK_TRACEBACK` is set.
    """

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        """Run the command; every failure ends with a message and an exit code."""

        def end(message: str, error: Exception | None, exit_code: int) -> NoReturn:
            typer.echo(strip_control_characters(message), err=True)
            report(message, error, exit_code)
            raise typer.Exit(exit_code) from None

        try:
            return command(*args, **kwargs)
        except (typer.Exit, BrokenPipeError):
            raise
        except InputError as error:
            end(str(error), error, BAD_INPUT)
        except SimulationError as error:
            end(f"{error}\n  Check the data of the line and of the pantographs.", error, BAD_INPUT)
        except KeyboardInterrupt as interruption:
            end("Interrupted.", None, interruption_exit_code(interruption))
        except Exception as error:
            if isinstance(error, OSError) and error.errno in FULL:
                raise  # the standard output; files end as `InputError`
            end(_describe_defect(error), error, BAD_INPUT)

    return run


def strip_control_characters(text: str) -> str:
    """Replace control characters, which a terminal would obey, in text that comes from a file."""
    return "".join(character if character.isprintable() or character == "\n" else "?" for character in text)


def _describe_defect(error: Exception) -> str:
    """Message of an internal error; prints the traceback on request."""
    if os.environ.get(TRACEBACK_VARIABLE):
        traceback.print_exc()
    return (
        f"internal error: {type(error).__name__}: {error}\n"
        "  This is a defect of Pantocheck. Please report it with the command and its input files.\n"
        f"  Set {TRACEBACK_VARIABLE}=1 to print the traceback."
    )
