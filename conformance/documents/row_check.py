"""Numbers of the consistency checks of a record, computed from its embedded signals again.

The embedded signals begin before the analysis section and end behind it, so that the checks of one pantograph over the
section give their numbers again. Checks of the motion, of the supports, of the roll-off and of copies need the whole
record. The embedded signals show a copy at the same place of the line all the same.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from itertools import permutations

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
from pantocheck.conformance.runs.check import DOES_NOT_APPLY, Check, Finding, worst_finding
from pantocheck.conformance.runs.force_content import CONTENT, COPY, FORCE_REMAINDER, find_likeness
from pantocheck.conformance.runs.force_dynamics import DYNAMICS, is_linear
from pantocheck.conformance.runs.implied_force import IMPLIED_FORCE
from pantocheck.conformance.runs.record_checks import COVERAGE, MEAN_FORCE

REPEATED = (COVERAGE, DYNAMICS, IMPLIED_FORCE, MEAN_FORCE, CONTENT)
"""Checks that need no more than the embedded signals and the case."""

SHARE_OF_THRESHOLD = 1e-4
"""Largest difference of a number from its computation, over its threshold.

Filters that begin at the embedded signals and not at the record change the numbers by 8.5e-6 of it or less."""


@dataclass(frozen=True)
class _EmbeddedSignals(RecordSignals):
    """Signals of one pantograph with the embedded uplift."""

    embedded_line: LineSignals | None = None

    @property
    def line(self) -> LineSignals:
        """Uplift at the supports."""
        assert self.embedded_line is not None
        return self.embedded_line

    @property
    def delivered_line(self) -> LineSignals:
        """Uplift at the supports, which is embedded if none has a fault."""
        return self.line


def check_rows(results: Results) -> list[DocumentCheck]:
    """Compute the numbers of the consistency checks again, as far as the embedded signals of library cases allow."""
    proved, differences = [], []
    for case, made, rows in _list_rows(results):
        if made is not None:
            names = ", ".join(row.check for row in rows if _is_repeated(row, made, case))
            proved += [f"{case.id} ({names})"] if names else []
            differences += [f"{case.id}, {text}" for text in _compare_rows(case, made, rows)]
    text = f"Numbers of consistency checks follow from the embedded signals: {'; '.join(proved)}."
    wrong = "Numbers of consistency checks do not follow from the embedded signals."
    return [judge_details(text, wrong, differences)] if proved else []


def name_other_rows(results: Results, repeated: Collection[str]) -> list[DocumentCheck]:
    """Consistency checks whose numbers were not computed again.

    Args:
        results: Results of a document.
        repeated: Cases that a record or a new run repeats.
    """
    others = []
    for case, made, rows in _list_rows(results):
        names = ", ".join(row.check for row in rows if not _is_repeated(row, made, case))
        reason = "they need the whole record" if made else "they need a library case with embedded signals"
        others += [f"{case.id}: {names}; {reason}"] if names and case.id not in repeated else []
    text = "The numbers of these consistency checks (option --record)."
    return [DocumentCheck("open", text, tuple(others))] if others else []


def _list_rows(results: Results) -> Iterator[tuple[CaseResult, Case | None, list[CheckRow]]]:
    """Cases with their library case and the rows of the checks that were made."""
    for case in results.cases:
        if case.record is not None and case.record.checks:
            yield case, _find_case(case), [row for row in case.record.checks if row.outcome != "not reached"]


def _is_repeated(row: CheckRow, case: Case | None, result: CaseResult) -> bool:
    """Whether the embedded signals repeat a row; an uplift with a fault, which bounds a mean force, is not embedded."""
    needs_uplift = row.check == MEAN_FORCE.name and isinstance(row.basis, Measured)
    if needs_uplift and result.signals is not None and not result.signals.uplift:
        return False
    return case is not None and row.check in {check.name for check in list_repeated(case)}


def _find_case(result: CaseResult) -> Case | None:
    """Case of the library with the inputs and limits of a result; None without one, or without signals."""
    case = find_library_case(result.id)
    if case is None or result.signals is None or result.library != "identical" or result.profile is not None:
        return None
    return case if (result.input_digest, result.limits_digest) == (case.digest, result.stated_limits_digest) else None


def list_repeated(case: Case) -> tuple[Check, ...]:
    """Checks that the embedded signals of a case repeat; one pantograph alone has no copy."""
    checks = (*REPEATED, COPY) if len(case.pantographs) == 1 else REPEATED
    linear = all(is_linear(case, number) for number in range(1, len(case.pantographs) + 1))
    # Friction and stops depend on the motion before the embedded signals.
    return checks if linear else tuple(check for check in checks if check not in (DYNAMICS, IMPLIED_FORCE))


def _compare_rows(result: CaseResult, case: Case, rows: list[CheckRow]) -> Iterator[str]:
    """Differences of the rows from those of the embedded signals."""
    assert result.signals is not None
    repeated = {check.name: check for check in list_repeated(case)}
    try:
        signals = unpack_signals(result.signals, case.file.filter)
        for row in rows:
            if row.check in repeated and _is_repeated(row, case, result):
                yield from compare_row(row, repeat_check(repeated[row.check], case, signals).basis, SHARE_OF_THRESHOLD)
            elif row.check == COPY.name:
                yield from _find_hidden_copy(row, signals)
    except ValueError as error:  # damaged signals, or such as no record has
        yield f"the checks cannot be made of the embedded signals: {error}"


def _find_hidden_copy(row: CheckRow, signals: UnpackedSignals) -> Iterator[str]:
    """A copy among the embedded signals: over the whole record, the remainder is no larger than among them."""
    if not isinstance(row.basis, Measured) or FORCE_REMAINDER.compare(row.basis.number).kind != "confirmed":
        return
    if row.basis.measure != FORCE_REMAINDER.name:
        return
    for (number, one), (other, two) in permutations(signals.pantographs.items(), 2):
        likeness = find_likeness(one.graded, two.force.graded)
        if likeness is not None and FORCE_REMAINDER.compare(likeness.remainder).kind != "confirmed":
            yield (
                f"check '{row.check}': {_describe(row.basis)} stated, but the force of pantograph {number} is a copy "
                f"of that of pantograph {other}: at most {format_exact(likeness.remainder)} follows"
            )


def compare_row(row: CheckRow, computed: RowBasis, share: float) -> Iterator[str]:
    """Difference of a row from its computation.

    Args:
        row: Row of the results.
        computed: Its number with the thresholds, or its cause, as computed.
        share: Largest difference of the number, over its largest threshold or the number [-].
    """
    stated = row.basis
    if isinstance(stated, Measured) and isinstance(computed, Measured):
        scale = max((*computed.thresholds.values(), abs(computed.number)))
        near = abs(stated.number - computed.number) <= share * scale
        stated = stated.model_copy(update={"number": computed.number} if near else {})
    if stated != computed:
        yield f"check '{row.check}': {_describe(row.basis)} stated, {_describe(computed)} follows"


def _describe(basis: RowBasis) -> str:
    if not isinstance(basis, Measured):
        return f"'{basis.cause}'"
    thresholds = (f"{outcome} beyond {format_exact(limit)}" for outcome, limit in basis.thresholds.items())
    number = f"{basis.measure} {format_exact(basis.number)} {basis.unit}".rstrip()
    return f"{number} ({', '.join((basis.part or 'whole record', *thresholds))})"


def repeat_check(check: Check, case: Case, signals: UnpackedSignals) -> Finding:
    """Worst finding of a check over the pantographs, each with its own part of the record.

    Args:
        check: Check of `list_repeated`.
        case: Case of the library.
        signals: Embedded signals.
    """
    if check is COPY:
        return DOES_NOT_APPLY
    findings = []
    for number, part in signals.pantographs.items():
        use, file = case.file.pantograph[number - 1], case.pantographs[number - 1]
        single = replace(
            case, file=case.file.model_copy(update={"pantograph": (use,), "spacing_m": ()}), pantographs=(file,)
        )
        height, strips = part.contact_height, [] if part.front_strip is None else [part.front_strip[None]]
        record = Record(
            time=np.arange(part.position.size) / part.rate,
            speed=case.speed,
            position=part.position[None],
            force=part.force.delivered[None],
            evaluated=part.section,
            filter_applied_Hz=part.filter_applied_Hz,
            contact_height=None if height is None else height[None],
            front_strip=strips[0] if strips else None,
            rear_strip=part.force.delivered[None] - strips[0] if strips else None,
        )
        finding = check.run(single, _EmbeddedSignals(record, case.file.filter, embedded_line=signals.line))
        basis = finding.basis
        named = basis.model_copy(update={"part": f"pantograph {number}"}) if isinstance(basis, Measured) else basis
        findings.append(replace(finding, basis=named))
    return worst_finding(findings)
