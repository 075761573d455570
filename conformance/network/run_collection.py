"""Collection of runs: a folder of Parquet tables, partitioned by line, track, date and run.

    runs/line=1700/track=2/date=2026-05-03/run=0123456789abcdef/    samples.parquet, run.toml, import.json
    runs/refused/                                                   one file per refused file, with the reason

A run is written into a folder with a temporary name, which is renamed when it is complete. The name of a run is the
digest of its force, so that the same measurement is one run in whichever file it comes. The table holds every column of
the file as it was; the sidecar, with its units, scales and clocks, prepares it at each reading.
"""

import datetime
import hashlib
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tomli_w
from filelock import FileLock, Timeout
from pydantic import Field, TypeAdapter

from pantocheck.conformance.core.extras import require_package
from pantocheck.conformance.core.files import check_writable, file_digest, write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import RoundedModel, read_json, validate_json, write_model
from pantocheck.conformance.core.measured_table import MeasuredTable
from pantocheck.conformance.core.table_sidecar import read_sidecar
from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.grading.assessed_record import find_missing_statement, hash_force
from pantocheck.conformance.records.channel_facts import find_time, list_channel_facts
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_reading import build_record_error, list_tables, read_samples
from pantocheck.conformance.records.record_sidecar import RecordSidecar
from pantocheck.conformance.records.source_tables import list_source_columns
from pantocheck.conformance.records.table_rows import read_single_table
from pantocheck.conformance.records.track_position import list_used_channels
from pantocheck.conformance.records.usable_sections import format_share, place_samples

SIDECAR, FACTS, REFUSED, STAGED = "run.toml", "import.json", "refused", ".staged-"
LARGEST_FACTS = 1_000_000
"""Largest size of the facts on a run [bytes]."""

MOST_REMARKS = 50
"""Largest number of remarks on a run that are kept."""


class FileDigest(RoundedModel):
    """Imported file."""

    name: str
    sha256: str


class RunImport(RoundedModel):
    """Facts on an imported run."""

    schema_: Annotated[Literal["pantocheck.import/1"], Field(alias="schema")] = "pantocheck.import/1"
    run: str
    """First digits of the SHA-256 of the force."""
    files: tuple[FileDigest, ...]
    """Sidecar and tables as they were given."""
    line: str
    track: str
    date: datetime.date
    system: str
    """Name of the measuring system; empty if the sidecar states none."""
    pantographs: tuple[str, ...]
    """Names of the pantographs in running order."""
    kilometres: Literal["increasing", "decreasing"]
    from_km: float
    to_km: float
    """Ends of the stated or, without a statement, of the recorded track."""
    seconds: float
    rate_Hz: float
    remarks: tuple[str, ...]
    """Suspicious contents."""

    @property
    def length_km(self) -> float:
        """Length of the track [km]."""
        return abs(self.to_km - self.from_km)


class RefusedFile(RoundedModel):
    """File that could not be imported."""

    schema_: Annotated[Literal["pantocheck.refused/1"], Field(alias="schema")] = "pantocheck.refused/1"
    file: str
    sha256: str | None
    """SHA-256 of the table; null if it could not be read."""
    reason: str


@dataclass(frozen=True)
class StoredRun:
    """Run of a collection."""

    sidecar: Path
    facts: RunImport


ImportState = Literal["imported", "known", "refused"]


@dataclass(frozen=True)
class ImportedFile:
    """Outcome of the import of one file."""

    name: str
    state: ImportState
    remarks: tuple[str, ...]
    """Reason of a refusal, or suspicious contents."""


def list_runs(folder: Path) -> Iterator[StoredRun]:
    """Runs of a collection, in the order of line, track, date and run."""
    for path in sorted(folder.glob(f"line=*/track=*/date=*/run=*/{FACTS}")):
        yield StoredRun(path.with_name(SIDECAR), _read_facts(path, RunImport))


def list_refused(folder: Path) -> list[RefusedFile]:
    """Files that were refused, by name."""
    found = (_read_facts(path, RefusedFile) for path in (folder / REFUSED).glob("*.json"))
    return sorted(found, key=lambda refused: refused.file)


def _read_facts(path: Path, model: Any) -> Any:
    where = f"collection, {path.parent.name}/{path.name}"
    return validate_json(read_json(path, "import", LARGEST_FACTS), TypeAdapter(model), where, "Import the run again.")


@contextmanager
def open_collection(folder: Path) -> Iterator[None]:
    """Hold a collection for writing; the unfinished rest of an interrupted import is removed.

    Raises:
        InputError: The package pyarrow is missing, the folder cannot be written, or another import writes it.
    """
    require_package("pyarrow", f"collection '{folder}'")
    check_writable(folder)
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(folder / "runs.lock", timeout=0):
            for rest in folder.glob(f"{STAGED}*"):
                shutil.rmtree(rest)
            yield
    except Timeout:
        raise InputError(f"folder '{folder}'", "another import writes it", "Wait for its end, or stop it.") from None


def import_files(files: Sequence[Path], folder: Path, shared: Path | None) -> Iterator[ImportedFile]:
    """Import files one after the other into a collection that is open; a refused file is noted and the next one read.

    Args:
        files: Tables or their sidecars.
        folder: Folder of the collection.
        shared: Sidecar of the files that have none beside them.
    """
    known = {run.facts.files[1].sha256: run.facts for run in list_runs(folder)}
    runs = {facts.run: facts for facts in known.values()}
    for path in files:
        note = folder / REFUSED / f"{hashlib.sha256(str(path).encode()).hexdigest()[:16]}.json"
        try:
            facts, state = _import_file(path, folder, shared, (known, runs))
        except InputError as error:
            reason = "; ".join(f"{part.where}: {part.found}. {part.hint}".rstrip(" .") for part in error.problems)
            write_model(note, RefusedFile(file=str(path), sha256=_try_digest(path), reason=reason[:2000]))
            yield ImportedFile(str(path), "refused", (reason,))
            continue
        known[facts.files[1].sha256] = facts
        runs[facts.run] = facts
        note.unlink(missing_ok=True)
        yield ImportedFile(str(path), state, facts.remarks)


def _try_digest(path: Path) -> str | None:
    try:
        return file_digest(path)
    except InputError:
        return None


def _import_file(
    path: Path, folder: Path, shared: Path | None, stored: tuple[dict[str, RunImport], dict[str, RunImport]]
) -> tuple[RunImport, ImportState]:
    """Import one file; `stored` holds the runs by the digest of a file and by their name."""
    sidecar, sidecar_path, table = _find_sidecar(path, shared)
    tables = [table, *(path.parent / source.file for source in sidecar.source)]
    digests = [FileDigest(name=file.name, sha256=file_digest(file)) for file in (sidecar_path, *dict.fromkeys(tables))]
    if (same := stored[0].get(digests[1].sha256)) is not None:
        return _compare_preparation(same, digests, path), "known"
    staged = Path(tempfile.mkdtemp(prefix=STAGED, dir=folder))
    try:
        remarks = _stage(sidecar, tables, staged)
        facts = _examine(staged / SIDECAR, digests, remarks)
        if (same := stored[1].get(facts.run)) is not None:
            found = f"has the force of the run {same.run}, imported from {same.files[1].name}"
            raise InputError(f"record '{path.name}'", found, "Import each measurement once.")
        write_model(staged / FACTS, facts)
        final = folder / f"line={facts.line}" / f"track={facts.track}" / f"date={facts.date}" / f"run={facts.run}"
        final.parent.mkdir(parents=True, exist_ok=True)
        staged.chmod(0o755)
        staged.replace(final)
    finally:
        shutil.rmtree(staged, ignore_errors=True)
    return facts, "imported"


def _find_sidecar(path: Path, shared: Path | None) -> tuple[RecordSidecar, Path, Path]:
    """Sidecar of a file with its path, and the table."""
    own = path.with_suffix(".toml")
    if shared is None or own.exists():
        return (*(found := read_sidecar(path, RecordSidecar))[:1], own, found[1])
    sidecar = read_model(shared, RecordSidecar, "sidecar")
    return sidecar.model_copy(update={"file": path.name, "sha256": None}), shared, path


def _compare_preparation(same: RunImport, digests: Sequence[FileDigest], path: Path) -> RunImport:
    """The known run of the same file; refused if its sidecar has changed."""
    if {file.sha256 for file in same.files} != {file.sha256 for file in digests}:
        found = f"was imported as run {same.run} with another sidecar or source"
        hint = f"Remove the folder run={same.run} to import it again."
        raise InputError(f"record '{path.name}'", found, hint)
    return same


def _stage(sidecar: RecordSidecar, tables: Sequence[Path], staged: Path) -> list[str]:
    """Write the tables of a record as Parquet with their sidecar; returns remarks on the columns that are used."""
    from pantocheck.conformance.core.parquet_table import write_parquet_table

    remarks: list[str] = []
    files: list[dict[str, object]] = []
    for number, (part, path) in enumerate(zip((sidecar, *sidecar.source), tables, strict=True)):
        used = list_used_channels(sidecar) if part is sidecar else list_source_columns(part)  # type: ignore[arg-type]
        table = read_single_table(path, part, used)
        remarks += _list_suspicions(table, used if part.columns is not None else ())
        name = "samples.parquet" if number == 0 else f"source-{number}.parquet"
        write_parquet_table(staged / name, table)
        files.append({"file": name, "sha256": file_digest(staged / name), "table": TextSettings()})
    sources = tuple(
        source.model_copy(update=changed) for source, changed in zip(sidecar.source, files[1:], strict=True)
    )
    content = sidecar.model_copy(update={**files[0], "source": sources})
    tree = content.model_dump(by_alias=True, exclude_none=True, exclude_defaults=True)
    write_atomically(staged / SIDECAR, tomli_w.dumps(tree).encode())
    return remarks


def _list_suspicions(table: MeasuredTable, used: Sequence[str]) -> Iterator[str]:
    for fact in list_channel_facts(table):
        if not used or fact.column.label in used:
            yield from (f"{fact.column.label}: {remark}" for remark in fact.remarks)
    time = find_time(table)
    yield from () if time is None else (f"time: {remark}" for remark in time.remarks)


def _examine(path: Path, files: Sequence[FileDigest], remarks: Sequence[str]) -> RunImport:
    """Facts on a staged record.

    Raises:
        InputError: The record is impossible, or states no line, track, date or kilometres.
    """
    samples, sidecar, _ = read_samples(path)
    where, measurement, track = f"sidecar '{files[0].name}'", sidecar.measurement, sidecar.track
    if measurement is None or track is None:
        missing = "measurement" if measurement is None else "track"
        hint = "State line, track and date in [measurement], zero_km and kilometres in [track]."
        raise InputError(f"{where}, key {missing}", "missing", hint)
    try:
        placed = place_samples(samples, sidecar)
    except RecordInvalid as error:
        raise build_record_error(list_tables(path, sidecar)[0].with_name(files[1].name), error) from None
    ends = sidecar.evaluated_m or (float(placed.position[0, 0]), float(placed.position[0, -1]))
    if (unknown := find_missing_statement(samples, sidecar.model_copy(update={"evaluated_m": ends}))) is not None:
        raise InputError(where, unknown, "Name the columns of time and position, or of the speed.")
    absent = ~np.isfinite(samples.force)
    lost = [f"force: {format_share(absent)} of the samples are missing"] if absent.any() else []
    return RunImport(
        run=hash_force(samples)[:16],
        files=tuple(files),
        line=measurement.line,
        track=measurement.track,
        date=measurement.date,
        system="" if sidecar.system is None else sidecar.system.name,
        pantographs=measurement.pantograph_names or tuple(str(i + 1) for i in range(sidecar.pantographs)),
        kilometres=track.kilometres,
        from_km=track.zero_km + track.direction * ends[0] / 1000,
        to_km=track.zero_km + track.direction * ends[1] / 1000,
        seconds=float(placed.time[-1] - placed.time[0]),
        rate_Hz=float(f"{1 / float(np.median(np.diff(placed.time))):.6g}"),
        remarks=tuple(dict.fromkeys((*remarks, *lost, *placed.warnings)))[:MOST_REMARKS],
    )
