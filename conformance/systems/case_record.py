"""Reading of the record of a case: section and start of the case stand for those that the sidecar lacks."""

from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_reading import read_record
from pantocheck.conformance.records.record_sidecar import RecordSidecar


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
