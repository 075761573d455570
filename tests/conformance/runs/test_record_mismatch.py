"""Record against its case: another speed, section, number of pantographs or spacing is another run.

Every tolerance is tested on both sides of the true value, just inside and just outside.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.runs.record_folder import find_other_case, find_record_mismatch


@pytest.fixture
def record(two_pantograph_case: Case, wave: Any) -> Record:
    return wave().record(two_pantograph_case)


def test_run_of_the_case_matches(two_pantograph_case: Case, record: Record) -> None:
    assert find_record_mismatch(two_pantograph_case, record) is None


@pytest.mark.parametrize(("factor", "matches"), [(0.994, False), (0.996, True), (1.004, True), (1.006, False)])
def test_speed_agrees_within_half_a_percent(
    two_pantograph_case: Case, record: Record, factor: float, matches: bool
) -> None:
    found = find_record_mismatch(two_pantograph_case, replace(record, speed=factor * record.speed))
    assert (found is None) is matches
    assert matches or "km/h, the case runs at 250 km/h" in str(found)


@pytest.mark.parametrize("shift", [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02), (9.0, 9.0), (-9.0, -9.0)])
def test_another_analysis_section_is_another_run(
    two_pantograph_case: Case, record: Record, shift: tuple[float, float]
) -> None:
    start, end = record.evaluated
    found = find_record_mismatch(two_pantograph_case, replace(record, evaluated=(start + shift[0], end + shift[1])))
    assert found is not None
    assert found.startswith("the record evaluates")


@pytest.mark.parametrize("rows", [[0], [1], [0, 1, 1]])
def test_fewer_or_more_pantographs_are_another_train(
    two_pantograph_case: Case, record: Record, rows: list[int]
) -> None:
    assert record.contact_height is not None
    other = replace(
        record, position=record.position[rows], force=record.force[rows], contact_height=record.contact_height[rows]
    )
    found = find_record_mismatch(two_pantograph_case, other)
    number = "1 pantograph" if len(rows) == 1 else f"{len(rows)} pantographs"
    assert found == f"the record has {number}, the case has 2"


@pytest.mark.parametrize("shift", [-50.0, -2.0, 2.0, 50.0])
def test_another_spacing_is_another_train(two_pantograph_case: Case, record: Record, shift: float) -> None:
    found = find_record_mismatch(
        two_pantograph_case, replace(record, position=record.position + np.array([[0.0], [shift]]))
    )
    assert found is not None
    assert "in the record, 150 m in the case" in found


@pytest.mark.parametrize(("shift", "matches"), [(-0.6, False), (-0.4, True), (0.4, True), (0.6, False)])
@pytest.mark.parametrize("number", [2, 3])
def test_each_distance_in_a_train_of_three_is_that_of_the_case(
    two_pantograph_case: Case, record: Record, number: int, shift: float, matches: bool
) -> None:
    """Distances of 150 m and 100 m; one pantograph and all behind it run closer or farther, tolerated to 0.5 m."""
    file = two_pantograph_case.file.model_copy(update={"spacing_m": (150.0, 100.0)})
    case = replace(two_pantograph_case, file=file, pantographs=two_pantograph_case.pantographs[:1] * 3)
    assert record.contact_height is not None
    position = record.position[0] - np.array([[0.0], [150.0], [250.0]])
    position[number - 1 :] -= shift
    rows = [0, 1, 1]
    other = replace(record, position=position, force=record.force[rows], contact_height=record.contact_height[rows])
    found = find_record_mismatch(case, other)
    assert (found is None) is matches
    assert matches or f"pantograph {number} runs" in str(found)


def test_record_of_another_version_has_any_other_digest(case_250: Case) -> None:
    """A digest counts to its last character. A record that states none is not refused here."""
    digest = case_250.digest
    other = digest[:-1] + ("0" if digest[-1] != "0" else "1")
    assert find_other_case(case_250, digest) is None
    assert find_other_case(case_250, None) is None
    assert f"its case_digest is {other}, that of the case is {digest}" in str(find_other_case(case_250, other))
