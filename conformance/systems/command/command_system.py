"""Program as a system under test: each case has its own process and working folder."""

import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_features import find_missing_features
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
    """Program that answers the messages of the protocol."""

    arguments: tuple[str, ...]
    """Program and arguments."""
    timeout_s: float
    """Time limit of a case [s]."""
    name: str
    version: str
    """Name and version that the program states."""
    start_failure: str | None = None
    """Reason why the program does not start; None if it starts."""
    kind: Literal["command"] = "command"

    def run(self, case: Case) -> Outcome:
        """Run a case in a new process; a failure of the process is an error of this case only."""
        if self.start_failure is not None:
            return Errored(self.start_failure)
        with tempfile.TemporaryDirectory(prefix="pantocheck-", ignore_cleanup_errors=True) as name:
            folder = Path(name)
            try:
                with Program(self.arguments, folder) as program:
                    started = _start_program(program, self.timeout_s)
                    if (reason := find_missing_features(case, started.features)) is not None:
                        program.send(encode_message("stop"))
                        program.wait_for_end()
                        return Skipped(reason)
                    begin = time.monotonic()
                    limit, content = self.timeout_s, build_case_message(case)
                    program.send(encode_message("run", id=RUN, folder=name, time_limit_s=limit, case=content))
                    answer = _parse_answer(program.read_line(limit))
                    wall = time.monotonic() - begin
                    program.send(encode_message("stop"))
                    warnings: tuple[str, ...] = ()
                    if not program.wait_for_end():
                        warnings = (f"{self.name} did not end after the message 'stop'; Pantocheck ended it",)
                    elif isinstance(answer, DeliveredAnswer):
                        answer = _find_late_error(program.read_late_lines()) or answer
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
        raise AnswerRefused("it answered 'run' with 'started'; expected 'delivered', 'skipped' or 'errored'")
    if answer.id != RUN:
        raise AnswerRefused(f"its answer has the id {answer.id}; expected {RUN}")
    return answer


def _find_late_error(lines: list[bytes]) -> ErroredAnswer | None:
    """Error that a program reports after its delivery; lines that are not messages are ignored."""
    for line in lines:
        with suppress(AnswerRefused):
            answer = parse_message(line)
            if isinstance(answer, ErroredAnswer):
                return answer
    return None


def _start_program(program: Program, limit: float) -> Started:
    """Send the message `start` and return the answer."""
    program.send(encode_message("start", protocol=PROTOCOL, suite_version=version("pantocheck")))
    answer = parse_message(program.read_line(min(limit, START_LIMIT)))
    if not isinstance(answer, Started):
        raise AnswerRefused(f"its first answer is {answer.message!r}; expected 'started'")
    if answer.protocol != PROTOCOL:
        raise AnswerRefused(f"it uses the protocol {answer.protocol!r}; expected {PROTOCOL!r}")
    return answer


def parse_command(text: str, base: Path, timeout: float) -> CommandSystem:
    """Build the system of a command; the program is started once for its name.

    Args:
        text: Text after `command:`.
        base: Base folder of relative file names.
        timeout: Time limit of a case [s].

    Returns:
        The program as a system under test.

    Raises:
        InputError: There is no such program.
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
            program.wait_for_end()
    except (ProgramFailed, AnswerRefused) as error:
        return CommandSystem(parts, timeout, name, "", start_failure=f"{name}: {error}")
    return CommandSystem(parts, timeout, identity.name, identity.version)
