"""Check of the stated state of a record: it must follow from the numbers of its checks, and from the remarks.

The outcome of a check follows from its number and its thresholds, which are those of the installed suite, and the state
from the outcomes.
"""

from collections.abc import Iterator

from pantocheck.conformance.core.check_row import CheckRow, Measured, NotMeasured
from pantocheck.conformance.quantities.filters import is_same_cutoff
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.force_dynamics import DYNAMICS
from pantocheck.conformance.runs.record_checks import RECORD_CHECKS, judge_record_state

REMARKS = {"doubt": "warnings", "unchecked": "notes"}
"""Key of a case with the text of a finding of each kind; a contradiction is the reason of the case."""


def check_state(case: CaseResult) -> Iterator[str]:
    """Contradictions of the state of a record with the rows of its checks, and of these with remarks of the case."""
    record = case.record
    if record is None:
        return
    if not record.checks:
        if record.state != "unconfirmed":
            yield f"state '{record.state}' of the record stated, but no check of it"
        return
    names, known = [row.check for row in record.checks], [check.name for check in RECORD_CHECKS]
    if names != known:
        yield f"the checks of the record are {', '.join(names)}; expected {', '.join(known)}"
    contradicted = False
    for row in record.checks:
        if (row.outcome == "not reached") != contradicted:
            place = "behind" if contradicted else "without"
            yield f"check '{row.check}': outcome '{row.outcome}' stated {place} a contradiction"
        contradicted = contradicted or row.outcome == "contradiction"
        yield from (f"check '{row.check}': {text}" for text in (*_check_basis(row), *_check_cause(case, row)))
        if bool(row.text) != (row.outcome not in ("confirmed", "not reached")):
            yield f"check '{row.check}': outcome '{row.outcome}' does not fit its text"
        if row.outcome in REMARKS and row.text not in getattr(case, REMARKS[row.outcome]):
            yield f"check '{row.check}': its text is missing among the {REMARKS[row.outcome]}"
    heights = () if case.signals is None else [part.contact_height_m for part in case.signals.pantographs.values()]
    if None in heights and any((row.check, row.outcome) == (DYNAMICS.name, "confirmed") for row in record.checks):
        yield f"check '{DYNAMICS.name}': confirmed without a contact height among the embedded signals"
    state, reason = judge_record_state(record.checks)
    if (record.state, record.reason) != (state, reason):
        stated = f"state '{record.state}' of the record stated ({record.reason})"
        yield f"{stated}; '{state}' follows from its checks ({reason})"
    texts = {row.text for row in record.checks}
    for name in known:
        for note in case.notes:
            if note.startswith(f"the {name} check was not made") and note not in texts:
                yield f"check '{name}': a note says that it was not made, its row does not"


def _check_basis(row: CheckRow) -> Iterator[str]:
    """The outcome must follow from the basis, and the thresholds must be those of the installed suite."""
    basis, check = row.basis, next((check for check in RECORD_CHECKS if check.name == row.check), None)
    if row.outcome != basis.outcome:
        yield f"outcome '{row.outcome}' stated, '{basis.outcome}' follows from its number or cause"
    if check is None:
        return
    if isinstance(basis, NotMeasured):
        if basis.cause not in (*check.causes, "not reached"):
            yield f"'{basis.cause}' stated; this check has a number"
        return
    installed = {measure.name: (measure.unit, measure.side, dict(measure.thresholds)) for measure in check.measures}
    if installed.get(basis.measure) != (basis.unit, basis.side, basis.thresholds):
        yield f"the number or the thresholds of '{basis.measure}' are not those of the installed suite"


def _check_cause(case: CaseResult, row: CheckRow) -> Iterator[str]:
    """A check that does not apply, or a threshold for filtered forces, must have a cause in the results."""
    basis, samples = row.basis, case.signals
    others = {} if case.record is None else {other.check: other for other in case.record.checks}
    applied = [] if samples is None else [part.filter_applied_Hz for part in samples.pantographs.values()]
    if isinstance(basis, Measured):
        for_filtered = {measure.name for check in RECORD_CHECKS for measure in check.measures if measure.for_filtered}
        if basis.measure in for_filtered and samples is not None and None in applied:
            yield f"'{basis.measure}' needs a filtered force, but the force was delivered without a filter"
        return
    if basis.cause == "named by another check" and all(other.outcome != "unchecked" for other in others.values()):
        yield "no other check names a missing channel"
    if basis.cause != "does not apply":
        return
    varying = [owner for owner, values in case.quantities.items() if values.get("std_force_N")]
    dynamics = others.get("dynamics")
    applies = {
        "roll-off": any(hertz is not None and is_same_cutoff(hertz, case.run.filter.cutoff_Hz) for hertz in applied),
        "implied force": dynamics is not None and isinstance(dynamics.basis, Measured),
        "copy": len(varying) > 1,
    }
    if applies.get(row.check):
        yield "'does not apply' stated, but the results show that it applies"
