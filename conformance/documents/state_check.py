"""Check of the stated state of a record: it must follow from the outcomes of its checks, and from the remarks."""

from collections.abc import Iterator

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
