"""Program as a system under test: a process and a working folder for each case."""

import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.results.outcome import Errored, Outcome, Skipped
from pantocheck.conformance.systems.command.case_message import build_case_message
from pantocheck.conformance.systems.command.delivery import DeliveryRefused, read_delivery
from pantocheck.conformance.systems.command.program import Program, ProgramFailed
from pantocheck.conformance.systems.command.program_arguments import split_arguments
from pantocheck.conformance.systems.command.protocol_messages import (
    PROTOCOL,
    AnswerRefused,
    DeliveredAnswer,
    ErroredAnswer,
    SkippedAnswer,
    Started,
    encode_message,
    parse_message,
)

START_LIMIT = 120.0
"""Time limit of the first answer of a program [s]; large environments need half a minute to start."""
RUN = 1
"""Number of the only run of a process; the protocol allows more."""


@dataclass(frozen=True)
class CommandSystem:
    """Program that answers the messages of the protocol.

    Parameters
    ----------
    arguments : tuple of str
        Program and arguments.
    timeout_s : float
        Time limit of a case [s].
    name, version : str
        Name and version that the program states.
    broken : str, optional
        Reason why the program cannot run any case; None if it started.
    """

    arguments: tuple[str, ...]
    timeout_s: float
    name: str
    version: str
    broken: str | None = None
    kind: Literal["command"] = "command"

    def run(self, case: Case) -> Outcome:
        """Run a case in a new process; every failure there is the error of this case only."""
        if self.broken is not None:
            return Errored(self.broken)
        with tempfile.TemporaryDirectory(prefix="pantocheck-", ignore_cleanup_errors=True) as name:
            folder = Path(name)
            try:
                with Program(self.arguments, folder) as program:
                    _start_program(program, self.timeout_s)
                    begin = time.monotonic()
                    limit, content = self.timeout_s, build_case_message(case)
                    program.send(encode_message("run", id=RUN, folder=name, time_limit_s=limit, case=content))
                    answer = _parse_answer(program.line(limit))
                    wall = time.monotonic() - begin
                    program.send(encode_message("stop"))
                    warnings: tuple[str, ...] = ()
                    if not program.ended():
                        warnings = (f"{self.name} did not end after the message stop, and was ended",)
                    elif isinstance(answer, DeliveredAnswer):
                        answer = _find_late_error(program.late_lines()) or answer
                        program.refuse_late_failure()
                match answer:
                    case SkippedAnswer():
                        return Skipped(answer.reason)
                    case ErroredAnswer():
                        return Errored(answer.reason)
                    case DeliveredAnswer():
                        return replace(read_delivery(case, answer, folder, wall), warnings=warnings)
            except (ProgramFailed, AnswerRefused, DeliveryRefused) as error:
                return Errored(f"{self.name}: {error}")
            except InputError as error:
                return Errored(f"{self.name}: {error.where}: {error.found}")


def _parse_answer(line: bytes) -> DeliveredAnswer | SkippedAnswer | ErroredAnswer:
    answer = parse_message(line)
    if isinstance(answer, Started):
        raise AnswerRefused("its answer to 'run' is 'started'")
    if answer.id != RUN:
        raise AnswerRefused(f"it answered run {answer.id} in place of run {RUN}")
    return answer


def _find_late_error(lines: list[bytes]) -> ErroredAnswer | None:
    """Error that a program reports after it has delivered; text that is no message is ignored."""
    for line in lines:
        with suppress(AnswerRefused):
            answer = parse_message(line)
            if isinstance(answer, ErroredAnswer):
                return answer
    return None


def _start_program(program: Program, limit: float) -> Started:
    """Send the message `start`; answer of the program."""
    program.send(encode_message("start", protocol=PROTOCOL, suite_version=version("pantocheck")))
    answer = parse_message(program.line(min(limit, START_LIMIT)))
    if not isinstance(answer, Started):
        raise AnswerRefused(f"its first answer is {answer.message!r}, not 'started'")
    if answer.protocol != PROTOCOL:
        raise AnswerRefused(f"it uses {answer.protocol!r}, the suite {PROTOCOL!r}")
    return answer


def parse_command(text: str, base: Path, timeout: float) -> CommandSystem:
    """Build the system of a command, and start the program once for its name.

    Parameters
    ----------
    text : str
        Text after `command:`.
    base : Path
        Base folder of relative file names.
    timeout : float
        Time limit of a case [s].

    Returns
    -------
    CommandSystem
        The program as a system under test.

    Raises
    ------
    InputError
        There is no such program.
    """
    parts = split_arguments(text, base)
    name = Path(parts[0]).name
    try:
        with (
            tempfile.TemporaryDirectory(prefix="pantocheck-", ignore_cleanup_errors=True) as folder,
            Program(parts, Path(folder)) as program,
        ):
            identity = _start_program(program, timeout)
            program.send(encode_message("stop"))
            program.ended()
    except (ProgramFailed, AnswerRefused) as error:
        return CommandSystem(parts, timeout, name, "", broken=f"{name}: {error}")
    return CommandSystem(parts, timeout, identity.name, identity.version)
