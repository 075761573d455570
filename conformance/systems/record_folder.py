"""A folder of records as a system: every record that names a case is graded as that case's run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import library_folder, source_text
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.toml_file import read_toml
from pantocheck.conformance.records.record_reading import RECORD_SCHEMAS, open_record, read_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.outcome import Delivered, Errored, Outcome, Skipped


@dataclass(frozen=True)
class RecordFolder:
    """Records of other simulators, or of measurements, found by the case their sidecars name.

    Parameters
    ----------
    name, version : str
        Of what the records come from, if their sidecars agree; else the folder's name.
    sidecars : tuple[tuple[str, Path], ...]
        Case id and sidecar, or summary record, of every record.
    """

    name: str
    version: str
    sidecars: tuple[tuple[str, Path], ...]
    kind: Literal["record"] = "record"

    def run(self, case: Case) -> Outcome:
        """Read the record of a case; a case without one is skipped."""
        path = dict(self.sidecars).get(case.id)
        if path is None:
            return Skipped("there is no record of this case")
        said = open_record(path)
        if isinstance(said, RecordSummary):
            return _of_summary(said, case)
        record, sidecar = read_record(path, None if case.is_static else case.analysis_section)
        return Delivered(record, run=sidecar.run)


def _of_summary(summary: RecordSummary, case: Case) -> Outcome:
    if (mismatch := _mismatch(summary, case)) is not None:
        return Errored(mismatch)
    source = (summary.source,) if isinstance(summary.source, str) else tuple(summary.source)
    return Delivered(
        run=summary.run,
        notes=(
            f"The values are a summary record, graded as given ({summary.trust}): {source_text(source)}",
            *((summary.note.strip(),) if summary.note else ()),
        ),
        warnings=summary.contradictions,
        summary=summary.evaluation,
    )


def _mismatch(summary: RecordSummary, case: Case) -> str | None:
    """Why a summary is not one of this case."""
    cutoff, speed = case.file.filter.cutoff_Hz, case.file.speed_km_h
    if len(summary.pantograph) != len(case.pantographs):
        return f"the summary record has {len(summary.pantograph)} pantographs, the case has {len(case.pantographs)}"
    if speed is not None and abs(summary.speed_km_h / speed - 1) > 0.005:
        return f"the summary record is of {summary.speed_km_h:g} km/h, the case runs at {speed:g} km/h"
    if abs(summary.filter_cutoff_Hz / cutoff - 1) > 0.001:
        return (
            f"the summary record's force was filtered at {summary.filter_cutoff_Hz:g} Hz, the case asks {cutoff:g} Hz"
        )
    stretch = summary.evaluated_m
    if stretch is not None and any(abs(a - b) > 0.01 for a, b in zip(stretch, case.analysis_section, strict=True)):
        (first, last) = case.analysis_section
        return f"the summary record evaluates {stretch[0]:g} m to {stretch[1]:g} m, the case {first:g} m to {last:g} m"
    return None


def open_record_folder(folder: Path) -> RecordFolder:
    """Find the records of a folder and the folders below it; a folder of the library may be named by its place there.

    Raises
    ------
    InputError
        There is no such folder or no record in it, a sidecar is wrong, or two are of the same case.
    """
    where = f"system record:{folder}"
    if not folder.is_dir() and not folder.is_absolute() and (library_folder() / folder).is_dir():
        folder = library_folder() / folder
    if not folder.is_dir():
        raise InputError(where, "there is no such folder", "Give the folder that holds records and their sidecars.")
    found: dict[str, Path] = {}
    systems = set()
    for path in sorted(folder.rglob("*.toml")):
        schema = read_toml(path, "sidecar").get("schema")
        if not isinstance(schema, str) or schema not in RECORD_SCHEMAS:
            continue
        said: RecordSidecar | RecordSummary = open_record(path)
        if said.case is None:
            continue
        if said.case in found:
            raise InputError(
                where,
                f"{path.name} and {found[said.case].name} are both of case {said.case}",
                "Keep one record of each case.",
            )
        found[said.case] = path
        systems.add((said.system.name, said.system.version) if said.system else (folder.resolve().name, ""))
    if not found:
        schemas = " or ".join(f'"{schema}"' for schema in RECORD_SCHEMAS)
        raise InputError(where, "no sidecar in it names a case", f'A sidecar says schema = {schemas} and case = "...".')
    name, version = systems.pop() if len(systems) == 1 else (folder.resolve().name, "")
    return RecordFolder(name, version, tuple(found.items()))
