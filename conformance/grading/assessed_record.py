"""What is assessed: a record or a summary, with its quantities and their uncertainty."""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.cases.profile_file import Profile
from pantocheck.conformance.input_files.atomic_writing import file_digest
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Evaluation, Value, evaluate_signals
from pantocheck.conformance.records.measured.block_bootstrap import FEWEST_BLOCKS, bootstrap_uncertainties
from pantocheck.conformance.records.measured.record_preparation import PreparedRecord, prepare_record
from pantocheck.conformance.records.record import RecordInvalid
from pantocheck.conformance.records.record_opening import open_record
from pantocheck.conformance.records.record_reading import build_record_error, read_samples
from pantocheck.conformance.records.record_sidecar import LineTable, RecordSidecar, SystemTable
from pantocheck.conformance.records.record_summary import RecordSummary
from pantocheck.conformance.results.results_format import InputGroup

ASSUMED_SPAN_M = 60.0
"""Length of a block of the bootstrap where the record does not say how long its spans are [m]."""


@dataclass(frozen=True)
class AssessedRecord:
    """A record as a profile sees it.

    Parameters
    ----------
    name : str
        Of its file.
    said : RecordSidecar or RecordSummary
        The sidecar, or the summary itself.
    line : LineTable
        What is known of the line, the command line's included.
    digest : str
        SHA-256 of all that was read, in hexadecimal.
    values : Evaluation
        Quantities, with those that follow from the line.
    uncertainty : dict[int, dict[str, float]]
        Half-width of their 95 % interval, by pantograph and name.
    signals : PreparedRecord or None
        That the quantities were computed from; None for a summary.
    """

    name: str
    said: RecordSidecar | RecordSummary
    line: LineTable
    digest: str
    values: Evaluation
    uncertainty: dict[int, dict[str, float]]
    signals: PreparedRecord | None
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def pantographs(self) -> tuple[int, ...]:
        """Numbers of the pantographs, from 1."""
        return tuple(of for of in self.values.values if of != LINE)

    @cached_property
    def system(self) -> SystemTable:
        """What the record comes from; its file if it does not say."""
        return self.said.system or SystemTable(name=self.name)

    @property
    def inputs(self) -> list[InputGroup]:
        """Where the numbers come from, if the record says so."""
        if not isinstance(self.said, RecordSummary):
            return []
        return [InputGroup(group=f"record {self.name}", trust=self.said.trust, source=source_text(self.said.source))]


def load_assessed_record(path: Path, profile: Profile, line: LineTable) -> AssessedRecord:
    """Read a record and compute its quantities as a profile asks.

    Parameters
    ----------
    path : Path
        Of a sidecar, a table beside its sidecar, or a summary record.
    profile : Profile
        Filter, and how far the speed may vary.
    line : LineTable
        What goes before the `line` table of the record.

    Raises
    ------
    InputError
        The record cannot be read, is impossible, or was filtered otherwise than the profile asks.
    """
    said = open_record(path)
    known = said.line.model_copy(update=line.model_dump(exclude_none=True))
    if isinstance(said, RecordSummary):
        return _of_summary(path, said, profile, known)
    samples, sidecar, table = read_samples(path)
    try:
        signals = prepare_record(samples, sidecar, profile.filter.low_pass, profile.speed_tolerance_pct)
    except RecordInvalid as error:
        raise build_record_error(table, error) from None
    digest = _joined(file_digest(path.with_suffix(".toml")), file_digest(table), known.model_dump_json())
    block = _block_length(known, sidecar)
    uncertain = {
        of: bootstrap_uncertainties(pooled, block / signals.speed, digest) for of, pooled in signals.pantographs.items()
    }
    notes = list(signals.notes)
    if any(uncertain.values()):
        notes.append(
            f"Uncertainties are half-widths of 95 % intervals from the length of the record (moving-block bootstrap, "
            f"blocks of {block:g} m)."
        )
    else:
        notes.append(f"The record is shorter than {FEWEST_BLOCKS} spans: the uncertainty of its statistics is unknown.")
    return AssessedRecord(
        name=path.stem,
        said=sidecar,
        line=known,
        digest=digest,
        values=_with_line(evaluate_signals(signals.pantographs, signals.line), known, sidecar.speed_km_h),
        uncertainty={of: values for of, values in uncertain.items() if values},
        signals=signals,
        notes=tuple(notes),
        warnings=signals.warnings,
    )


def _of_summary(path: Path, summary: RecordSummary, profile: Profile, line: LineTable) -> AssessedRecord:
    cutoff = profile.filter.cutoff_Hz
    if abs(summary.filter_cutoff_Hz / cutoff - 1) > 0.001:
        raise InputError(
            f"summary record '{path.name}', key filter_cutoff_Hz",
            f"the force was filtered at {summary.filter_cutoff_Hz:g} Hz, profile {profile.name} asks {cutoff:g} Hz",
            "Take the statistics with the profile's filter.",
        )
    return AssessedRecord(
        name=path.stem,
        said=summary,
        line=line,
        digest=_joined(file_digest(path.with_suffix(".toml")), line.model_dump_json()),
        values=_with_line(summary.evaluation, line, summary.speed_km_h),
        uncertainty={},
        signals=None,
        notes=(f"{path.stem} is a summary record: its values are graded as given.",),
        warnings=summary.contradictions,
    )


def _block_length(line: LineTable, sidecar: RecordSidecar) -> float:
    """Length of a span [m]: as stated, or from the supports."""
    if line.span_m is not None:
        return line.span_m
    distances = np.diff(np.unique(sidecar.support_position_m or ()))
    likely = distances[(distances >= 20) & (distances <= 120)]
    return float(np.median(likely)) if likely.size else ASSUMED_SPAN_M


def _with_line(found: Evaluation, line: LineTable, speed_km_h: float) -> Evaluation:
    """Quantities with those that are stated of the line, or follow from what is."""
    of_line: dict[str, Value] = dict(found.values[LINE])
    given = of_line.get("wave_speed_m_s", line.wave_speed_m_s)
    wave_speed = line.wave_speed_m_s if line.wave_speed_m_s is not None else given
    if isinstance(wave_speed, float) and wave_speed > 0:
        of_line |= {"wave_speed_m_s": wave_speed, "speed_over_wave_speed": speed_km_h / 3.6 / wave_speed}
    ordered = {name: of_line[name] for name in QUANTITIES if name in of_line}
    return Evaluation({**found.values, LINE: ordered}, found.skipped)


def _joined(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
