"""Folder of records as a system: a record with the id of a case is graded as the run of this case."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.core.extras import refuse_missing_package
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.table_sidecar import locate_table, record_digest
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.filters import is_same_cutoff
from pantocheck.conformance.records.column_values import list_sensor_warnings
from pantocheck.conformance.records.record import SPEED_TOLERANCE, Record
from pantocheck.conformance.records.record_reading import RECORD_SCHEMAS, open_record, read_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.runs.system import Delivered, Errored, Outcome, Skipped, note_case_version

if TYPE_CHECKING:
    from pantocheck.conformance.runs.delivered_motion import DeliveredMotion


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
        name = sidecar.shapes
        drawn = None if name is None else read_motion(case, record, locate_table(path, name, None))
        return Delivered(
            record,
            line_shape=None if drawn is None else drawn.line_shape,
            motion=None if drawn is None else drawn.motion,
            run=sidecar.run,
            start=sidecar.start,
            notes=note_case_version(sidecar.case_digest),
            warnings=tuple(list_sensor_warnings(sidecar.columns)),
            case_digest=sidecar.case_digest,
            digest=record_digest(path, path.parent / sidecar.file),
        )


def read_motion(case: Case, record: Record, path: Path) -> "DeliveredMotion":
    """Moving picture from delivered shapes of the wires; the model of the line and HDF5 load for them alone."""
    with refuse_missing_package(f"shapes '{path.name}'"):
        from pantocheck.conformance.runs.delivered_motion import build_delivered_motion
    return build_delivered_motion(case, record, path)


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


# Reading of the record of a case: section and start of the case stand for those that the sidecar lacks.
def read_case_record(path: Path, case: Case) -> tuple[Record, RecordSidecar]:
    """Read the record of a case.

    Args:
        path: Sidecar of the record.
        case: Case that the record belongs to.

    Returns:
        Record and its sidecar.

    Raises:
        InputError: A file is missing, damaged or contradictory. A missing start is named with that of the case.
    """
    if case.is_static:
        return read_record(path)
    return read_record(path, case.analysis_section, case.start_positions[0])


# Difference between a record and the run of a case that it should represent.
SECTION_TOLERANCE_M = 0.01
"""Tolerance of the analysis section of a record against that of its case [m]."""

SPACING_TOLERANCE_M = 0.5
"""Tolerance of the distance between two pantographs [m].

A train at 250 km/h travels 3.5 m in one period of 20 Hz; the tolerance is a seventh of it. The tolerance of the speed
gives the same error at a distance of 100 m."""


def find_record_mismatch(case: Case, record: Record) -> str | None:
    """Reason why a record is not a run of a case; None if it is one.

    Args:
        case: Case with its train.
        record: Delivered record.
    """
    other = _find_other_run(case, record.pantographs, 3.6 * record.speed, record.evaluated)
    return f"the record {other}" if other is not None else _find_other_spacing(case, record)


def find_summary_mismatch(case: Case, summary: RecordSummary) -> str | None:
    """Reason why a summary record is not of a run of a case; None if it is.

    Args:
        case: Case with its train.
        summary: Delivered summary record.
    """
    other = _find_other_run(case, len(summary.pantograph), summary.speed_km_h, summary.evaluated_m)
    if other is not None:
        return f"the summary record {other}"
    stated, cutoff = summary.filter_cutoff_Hz, case.file.filter.cutoff_Hz
    if not is_same_cutoff(stated, cutoff):
        return f"the summary record has a filter of {stated:g} Hz, the case requires {cutoff:g} Hz"
    return None


def _find_other_run(case: Case, pantographs: int, speed_km_h: float, section: Sequence[float] | None) -> str | None:
    """Difference of train, speed or analysis section from a case; a static case has no speed."""
    if pantographs != len(case.pantographs):
        return f"has {count_noun(pantographs, 'pantograph')}, the case has {len(case.pantographs)}"
    expected = case.file.speed_km_h
    if expected is not None and not abs(speed_km_h / expected - 1) <= SPEED_TOLERANCE:
        return f"was made at {speed_km_h:.4g} km/h, the case runs at {expected:.4g} km/h"
    start, end = case.analysis_section
    if section is not None and not max(abs(section[0] - start), abs(section[1] - end)) <= SECTION_TOLERANCE_M:
        return f"evaluates {section[0]:g} m to {section[1]:g} m, the case {start:g} m to {end:g} m"
    return None


def _find_other_spacing(case: Case, record: Record) -> str | None:
    for number, expected in enumerate(case.file.spacing_m or (), 2):
        distance = record.position[number - 2] - record.position[number - 1]
        worst = float(distance[np.abs(distance - expected).argmax()])
        if not abs(worst - expected) <= SPACING_TOLERANCE_M:
            return (
                f"pantograph {number} runs {worst:.5g} m behind pantograph {number - 1} in the record, "
                f"{expected:g} m in the case"
            )
    return None


def find_other_case(case: Case, case_digest: str | None) -> str | None:
    """Reason why a record was made with other inputs than those of a case; None if it was not, or does not state it.

    Args:
        case: Case that is graded.
        case_digest: Digest of the inputs of the case, as the record states it.
    """
    if case_digest in {None, case.digest}:
        return None
    return (
        f"the record was made with other inputs than those of the case: its case_digest is {case_digest}, "
        f"that of the case is {case.digest}"
    )
