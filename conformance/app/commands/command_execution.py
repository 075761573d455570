"""Execution of a command, and the signals that end a run.

=========================  ==================================================
time of the signal         effect
=========================  ==================================================
before or in a case        the run ends; the finished cases are written
after the last case        the reports are written completely, then the run ends
second signal              the command ends at once
=========================  ==================================================
"""

import inspect
from collections.abc import Callable
from functools import partial

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput, print_failure, print_output
from pantocheck.conformance.app.commands.guard import guard_command
from pantocheck.conformance.app.commands.log_output import write_log
from pantocheck.conformance.app.commands.output_settings import (
    FLAGS,
    add_flags,
    combine_flags,
    list_given,
    use_settings,
)


def build_executable(name: str, command: Callable[..., CommandOutput]) -> Callable[..., None]:
    """Function for typer that runs a command, prints its output and ends with its exit code.

    It has the parameters of the command and the options of the output, which count before the command, too.
    """

    def run(context: typer.Context, **arguments: object) -> None:
        given = {flag: bool(arguments.pop(flag)) for flag in FLAGS}
        with use_settings(combine_flags(context.obj | list_given(given))):
            raise typer.Exit(guard_command(execute, partial(print_failure, name))(**arguments))

    def execute(**arguments: object) -> int:
        with write_log():
            output = command(**arguments)
        print_output(output, name)
        return output.exit_code

    own = inspect.signature(run).parameters["context"]
    parameters = [own, *inspect.signature(command, eval_str=True).parameters.values()]
    parameters = [parameter.replace(kind=parameter.KEYWORD_ONLY) for parameter in parameters]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__doc__ = command.__doc__
    return add_flags(run, "hidden")
