"""Program as a system under test: each case has its own process and working folder."""

import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, cast

from pantocheck.conformance.cases.case import Case, drop_keys, find_missing_features, list_case_features
from pantocheck.conformance.cases.lift_force import AppliedForces
from pantocheck.conformance.core.files import NO_LINK, file_digest
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.core.table_sidecar import record_digest
from pantocheck.conformance.pantograph.force_law import AppliedForceLaw
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.runs.derived_values import build_derived
from pantocheck.conformance.runs.program import Program, ProgramFailed, split_arguments
from pantocheck.conformance.runs.protocol_messages import (
    PROTOCOL,
    AnswerRefused,
    DeliveredAnswer,
    ErroredAnswer,
    File,
    RequestedAppliedForces,
    SkippedAnswer,
    Started,
    encode_message,
    parse_message,
)
from pantocheck.conformance.runs.record_folder import read_case_record, read_motion
from pantocheck.conformance.runs.system import Delivered, Errored, Outcome, Skipped, note_case_version

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


# Files that a program delivers: they must be in its folder, unchanged, and of the requested case.
class DeliveryRefused(ValueError):
    """Files are missing, changed, outside the folder or of another case: they do not represent the requested run."""


def read_delivery(case: Case, answer: DeliveredAnswer, folder: Path, wall: float) -> Delivered:
    """Read the delivered files, after the program has ended and cannot change them any more.

    Args:
        case: Requested case.
        answer: Answer of the program.
        folder: Folder of the run.
        wall: Time from request to answer [s].

    Returns:
        Record, static quantities and run facts.

    Raises:
        DeliveryRefused: A file does not agree with the answer.
        InputError: The record is invalid.
    """
    if answer.record is None:
        return Delivered(static=dict(answer.static), run=RunTable(wall_s=wall), notes=answer.notes)
    sidecar_path, table_path = (_check_file(file, folder) for file in (answer.record.sidecar, answer.record.table))
    record, sidecar = read_case_record(sidecar_path, case)
    if sidecar_path.parent / sidecar.file != table_path:
        raise DeliveryRefused(f"the sidecar names the table {sidecar.file!r}, the answer {answer.record.table.file!r}")
    if sidecar.case != case.id:
        raise DeliveryRefused(f"the record is of case {sidecar.case!r}; expected {case.id!r}")
    drawn = None
    if answer.record.shapes is not None and not case.is_static:
        shapes = _check_file(answer.record.shapes, folder)
        if sidecar.shapes is None or sidecar_path.parent / sidecar.shapes != shapes:
            found = f"the sidecar names the shapes {sidecar.shapes!r}, the answer {answer.record.shapes.file!r}"
            raise DeliveryRefused(found)
        drawn = read_motion(case, record, shapes)
    run = sidecar.run
    if run.wall_s is None:
        run = run.model_copy(update={"wall_s": wall})
    notes = (*answer.notes, *note_case_version(sidecar.case_digest))
    return Delivered(
        record,
        dict(answer.static),
        run,
        notes,
        case_digest=sidecar.case_digest,
        digest=record_digest(sidecar_path, table_path),
        start=sidecar.start,
        line_shape=None if drawn is None else drawn.line_shape,
        motion=None if drawn is None else drawn.motion,
    )


def _check_file(file: File, folder: Path) -> Path:
    root = folder.resolve()
    try:
        path = (root / file.file).resolve()
        if not path.is_relative_to(root):
            raise DeliveryRefused(f"the file {file.file!r} lies outside the folder of the run")
        if not path.is_file():
            raise DeliveryRefused(f"there is no file {file.file!r} in the folder of the run")
        digest = file_digest(path, NO_LINK)
    except DeliveryRefused:
        raise
    except (OSError, ValueError) as error:
        raise DeliveryRefused(f"the file {file.file!r} cannot be read ({error})") from None
    if digest != file.sha256:
        raise DeliveryRefused(f"the SHA-256 of the file {file.file!r} is not that of the answer")
    return path


# Case in the `run` message of a program: all numbers, without limits.
def build_case_message(case: Case) -> dict[str, Any]:
    """Build the case of a `run` message, see `protocol_messages.RequestedCase`.

    Notes and sources are left out, because they mention results.

    Raises:
        SimulationError: The line has no equilibrium at rest or at the start.
    """
    file = case.file
    content: dict[str, Any] = {
        "id": case.id,
        "case_digest": case.digest,
        "title": file.title,
        "features": list_case_features(case),
        "speed_km_h": file.speed_km_h,
        "evaluated_m": list(case.analysis_section),
        "filter": file.filter.model_dump(mode="json"),
        "discretisation": file.discretisation.model_dump(mode="json"),
        "line": case.line.model_dump(mode="json"),
        "pantographs": [
            {
                **model.model_dump(mode="json", exclude={"title", "force_law"}),
                "uplift_force_N": lift.stated_uplift_force,
                "target_mean_force_N": lift.target_mean_force,
                **_applied_forces(case, number),
                "start_m": start,
                "end_m": end,
            }
            for number, (lift, model, start, end) in enumerate(
                zip(case.lift_forces, case.pantographs, case.start_positions, case.end_positions, strict=True), 1
            )
        ],
        "derived": build_derived(case).model_dump(mode="json"),
    }
    return cast(dict[str, Any], drop_keys(content, PROVENANCE))


def _applied_forces(case: Case, number: int) -> dict[str, Any]:
    """Key `applied_forces` of a pantograph whose force law gives them, or no key."""
    lift, law = case.law_forces.get(number), case.pantographs[number - 1].force_law
    if not (isinstance(lift, AppliedForces) and isinstance(law, AppliedForceLaw)):
        return {}
    forces = RequestedAppliedForces(
        static_force_N=lift.static_force,
        aerodynamic_force_N=lift.aerodynamic_force,
        aerodynamic_force_on=law.aerodynamic_force.on,
    )
    return {"applied_forces": forces.model_dump(mode="json")}
