"""Files that a program delivers: they must be in its folder, unchanged, and of the requested case."""

from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.input_files.bounded_file import NO_LINK, file_digest
from pantocheck.conformance.records.record_reading import record_digest
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, note_case_version
from pantocheck.conformance.systems.case_record import read_case_record
from pantocheck.conformance.systems.command.protocol_messages import DeliveredAnswer, File


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
