"""Uplift behind the active window: right or missing in the record of a case, and no reason for a skip."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import discretise, simulate_passage

UPLIFT = "max_uplift_at_support_mm"


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(library_folder() / "en50318-2002" / "250.toml")


@pytest.fixture(scope="module")
def records(case: Case) -> tuple[Record, Record]:
    """The case with its active window, and with the whole line active."""
    line = discretise(build_catenary(case.line), case.file.discretisation.element_m)
    windowed = build_passage(case, line, case.file.discretisation, (120.0,))
    whole = replace(windowed, kept_behind=math.inf)
    first, second = (record_passage(case, passage, simulate_passage(line, passage)) for passage in (windowed, whole))
    return first, second


def test_record_of_a_case_holds_the_uplift_of_the_whole_line_or_none(records: tuple[Record, Record]) -> None:
    """Known until the pantograph is at least 1.5 spans of 60 m past each support; equal to 1e-9 m there."""
    windowed, whole = records
    known = np.isfinite(windowed.support_uplift)
    assert not known.all()
    assert np.isfinite(whole.support_uplift).all()
    assert np.abs(windowed.support_uplift - whole.support_uplift)[known].max() < 1e-9
    assert known[windowed.position <= windowed.support_position[:, None] + 90.0].all()
    assert np.abs(windowed.force - whole.force).max() < 1e-8


def test_missing_uplift_changes_no_grade_in_memory_or_from_a_file(
    case: Case, records: tuple[Record, Record], tmp_path: Path
) -> None:
    """The same verdict and uplift from the windowed record, from the whole one and from a written file."""
    windowed, whole = (grade_case(case, Delivered(record), "secondary") for record in records)
    write_record(tmp_path / "run.csv", records[0], case.id, further={"case_digest": case.digest})
    read = run_case(case, open_record_folder(tmp_path), "secondary")
    for result in (windowed, whole, read):
        assert result.verdict == "pass"
        assert result.record is not None
        assert result.record.state == "verified"
        assert result.quantities["0"][UPLIFT] == pytest.approx(whole.quantities["0"][UPLIFT], abs=1e-6)
