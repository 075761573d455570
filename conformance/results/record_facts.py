"""Facts about the record of a case in results.json."""

from typing import Literal

from pantocheck.conformance.core.results_part import ResultsPart

RecordState = Literal["verified", "unverified", "contradicted"]
"""Result of the consistency checks of a record: confirmed, not all of them possible, or refuted."""

StartState = Literal["as in the case", "differs", "not stated"]
"""Start of a record against that of its case; `not stated` is never treated better than `as in the case`."""


class RecordFacts(ResultsPart):
    """Record of a case. Digests are SHA-256 in hexadecimal, null if unknown.

    `demanded` is false if a profile shows the state `unverified` without lowering the verdict. `digest` is that of the
    record. `case_digest` is that of the case for which the record was made, as the record states it. `measured_digest`
    is that of the measured record, if a profile compares with one. `start` compares the stated start of the record with
    that of its case, null without a case; `start_text` is the remark on it.
    """

    state: RecordState
    reason: str
    demanded: bool = True
    digest: str | None = None
    case_digest: str | None = None
    measured_digest: str | None = None
    start: StartState | None = None
    start_text: str | None = None
