"""Folder of records as a system: a record with the id of a case is graded as the run of this case."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.grading.record_mismatch import find_summary_mismatch
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_toml
from pantocheck.conformance.records.logger.sensor_warnings import list_sensor_warnings
from pantocheck.conformance.records.record_reading import RECORD_SCHEMAS, open_record, record_digest
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.outcome import Delivered, Errored, Outcome, Skipped, note_case_version
from pantocheck.conformance.systems.case_record import read_case_record


@dataclass(frozen=True)
class RecordFolder:
    """Records of other simulators or of measurements, by the case id of their sidecars."""

    name: str
    version: str
    """System that all sidecars name; otherwise the name of the folder."""
    sidecars: tuple[tuple[str, Path], ...]
    """Case id and file of every sidecar or summary record."""
    kind: Literal["record"] = "record"

    def run(self, case: Case) -> Outcome:
        """Read the record of a case; a case without a record is skipped."""
        path = dict(self.sidecars).get(case.id)
        if path is None:
            return Skipped("there is no record of this case")
        opened = open_record(path)
        if isinstance(opened, RecordSummary):
            return _deliver_summary(opened, case, record_digest(path))
        record, sidecar = read_case_record(path, case)
        return Delivered(
            record,
            run=sidecar.run,
            start=sidecar.start,
            notes=note_case_version(sidecar.case_digest),
            warnings=tuple(list_sensor_warnings(sidecar.columns)),
            case_digest=sidecar.case_digest,
            digest=record_digest(path, path.parent / sidecar.file),
        )


def _deliver_summary(summary: RecordSummary, case: Case, digest: str) -> Outcome:
    if (mismatch := find_summary_mismatch(case, summary)) is not None:
        return Errored(mismatch)
    source = (summary.source,) if isinstance(summary.source, str) else tuple(summary.source)
    return Delivered(
        run=summary.run,
        start=summary.start,
        notes=(
            f"The values are a summary record, graded as given ({summary.trust}): {source_text(source)}",
            *((summary.note.strip(),) if summary.note else ()),
            *note_case_version(summary.case_digest),
        ),
        warnings=summary.contradictions,
        summary=summary.evaluation,
        case_digest=summary.case_digest,
        digest=digest,
    )


def open_record_folder(folder: Path) -> RecordFolder:
    """Find the records of a folder and of the folders below it.

    Args:
        folder: Folder; a relative path may start at the library.

    Returns:
        System with the records of the folder.

    Raises:
        InputError: There is no such folder or no record in it, a sidecar is invalid, or two sidecars have the same
            case.
    """
    where = f"system record:{folder}"
    if not folder.is_dir() and not folder.is_absolute() and (library_folder() / folder).is_dir():
        folder = library_folder() / folder
    if not folder.is_dir():
        raise InputError(where, "there is no such folder", "Give the folder of the records and their sidecars.")
    paths: dict[str, Path] = {}
    systems = set()
    for path in sorted(folder.rglob("*.toml")):
        schema = read_toml(path, "sidecar").get("schema")
        if not isinstance(schema, str) or schema not in RECORD_SCHEMAS:
            continue
        opened = open_record(path)
        if opened.case is None:
            continue
        if opened.case in paths:
            names = f"{path.name} and {paths[opened.case].name}"
            raise InputError(where, f"{names} have the same case {opened.case}", "Keep one record of each case.")
        paths[opened.case] = path
        systems.add((opened.system.name, opened.system.version) if opened.system else (folder.resolve().name, ""))
    if not paths:
        schemas = " or ".join(f'"{schema}"' for schema in RECORD_SCHEMAS)
        raise InputError(
            where, "no sidecar in this folder names a case", f'A sidecar has schema = {schemas} and case = "...".'
        )
    name, version = systems.pop() if len(systems) == 1 else (folder.resolve().name, "")
    return RecordFolder(name, version, tuple(paths.items()))
