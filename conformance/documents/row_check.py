"""Numbers of the consistency checks of a record, computed from its embedded signals again.

The embedded signals begin before the analysis section and end behind it, so that the checks of one pantograph over the
section give their numbers again. Checks of the supports, of the roll-off and of copies need the whole record.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import find_library_case
from pantocheck.conformance.core.check_row import CheckRow, Measured, RowBasis
from pantocheck.conformance.documents.authenticity_check import DocumentCheck, format_exact, judge_details
from pantocheck.conformance.quantities.line_signals import LineSignals
from pantocheck.conformance.records.evaluated_signals import UnpackedSignals, unpack_signals
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.results_format import CaseResult, Results
from pantocheck.conformance.runs.check import Check, worst_finding
from pantocheck.conformance.runs.force_content import CONTENT
from pantocheck.conformance.runs.force_dynamics import DYNAMICS
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE
from pantocheck.conformance.runs.record_checks import COVERAGE, MEAN_FORCE

REPEATED = (COVERAGE, DYNAMICS, IMPLIED_FORCE, MEAN_FORCE, CONTENT)
"""Checks that need no more than the embedded signals and the case."""

SHARE_OF_THRESHOLD = 1e-4
"""Largest difference of a number from its computation, over its threshold.

Filters that begin at the embedded signals and not at the record change the numbers by 1e-9 of it or less."""


@dataclass(frozen=True)
class _EmbeddedSignals(RecordSignals):
    """Signals of one pantograph with the embedded uplift."""

    embedded_line: LineSignals | None = None

    @property
    def line(self) -> LineSignals:
        """Uplift at the supports."""
        assert self.embedded_line is not None
        return self.embedded_line


def check_rows(results: Results) -> list[DocumentCheck]:
    """Compute the numbers of the consistency checks again, as far as the embedded signals of library cases allow."""
    proved, differences, others = [], [], []
    for case in results.cases:
        if case.record is None or not case.record.checks:
            continue
        made = _find_case(case)
        rows = [row for row in case.record.checks if row.outcome != "not reached"]
        repeated = {check.name: check for check in REPEATED if made is not None}
        differences += [f"{case.id}, {text}" for text in _compare_rows(case, made, rows)] if made else []
        names = {verb: [row.check for row in rows if (row.check in repeated) == verb] for verb in (True, False)}
        proved += [f"{case.id} ({', '.join(names[True])})"] if names[True] else []
        reason = "they need the whole record" if made else "they need a library case with embedded signals"
        others += [f"{case.id}: {', '.join(names[False])}; {reason}"] if names[False] else []
    checks = []
    if proved:
        text = f"Numbers of consistency checks follow from the embedded signals: {'; '.join(proved)}."
        wrong = "Numbers of consistency checks do not follow from the embedded signals."
        checks.append(judge_details(text, wrong, differences))
    if others:
        checks.append(
            DocumentCheck("open", "The numbers of these consistency checks (option --record).", tuple(others))
        )
    return checks


def _find_case(result: CaseResult) -> Case | None:
    """Case of the library with the inputs and limits of a result; None without one, or without signals."""
    case = find_library_case(result.id)
    if case is None or result.signals is None or result.library != "identical" or result.profile is not None:
        return None
    return case if (result.input_digest, result.limits_digest) == (case.digest, result.stated_limits_digest) else None


def _compare_rows(result: CaseResult, case: Case, rows: list[CheckRow]) -> Iterator[str]:
    """Differences of the rows from those of the embedded signals."""
    assert result.signals is not None
    try:
        signals = unpack_signals(result.signals, case.file.filter)
        for row in rows:
            check = next((check for check in REPEATED if check.name == row.check), None)
            if check is not None:
                yield from _compare(row, _repeat(check, case, signals))
    except ValueError as error:  # damaged signals, or such as no record has
        yield f"the checks cannot be made of the embedded signals: {error}"


def _compare(row: CheckRow, computed: RowBasis) -> Iterator[str]:
    stated = row.basis
    if isinstance(stated, Measured) and isinstance(computed, Measured):
        tolerance = SHARE_OF_THRESHOLD * max(computed.thresholds.values(), default=1.0)
        near = abs(stated.number - computed.number) <= max(tolerance, SHARE_OF_THRESHOLD * abs(computed.number))
        if near and stated.measure == computed.measure:
            return
    if stated != computed:
        yield f"check '{row.check}': {_describe(stated)} stated, {_describe(computed)} follows"


def _describe(basis: RowBasis) -> str:
    if not isinstance(basis, Measured):
        return f"'{basis.cause}'"
    return f"{basis.measure} {format_exact(basis.number)} {basis.unit}".rstrip()


def _repeat(check: Check, case: Case, signals: UnpackedSignals) -> RowBasis:
    """Worst basis of a check over the pantographs, each with its own part of the record."""
    findings = []
    for number, part in signals.pantographs.items():
        use, file = case.file.pantograph[number - 1], case.pantographs[number - 1]
        single = replace(
            case, file=case.file.model_copy(update={"pantograph": (use,), "spacing_m": ()}), pantographs=(file,)
        )
        height = part.contact_height
        record = Record(
            time=np.arange(part.position.size) / part.rate,
            speed=case.speed,
            position=part.position[None],
            force=part.force.delivered[None],
            evaluated=part.section,
            filter_applied_Hz=part.filter_applied_Hz,
            contact_height=None if height is None else height[None],
        )
        finding = check.run(single, _EmbeddedSignals(record, case.file.filter, embedded_line=signals.line))
        basis = finding.basis
        named = basis.model_copy(update={"part": f"pantograph {number}"}) if isinstance(basis, Measured) else basis
        findings.append(replace(finding, basis=named))
    return worst_finding(findings).basis
