"""Support passing check: kink and coincidence, each alone and of either pantograph."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from helpers.wave_system import Wave
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.execution.runner import run_case
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.check import Finding, report_missing
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.support_passing import SUPPORT_PASSING
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model import discretise, simulate_passage

KINK, SMOOTH = 5.0, 40.0
"""Widths of a bump of uplift [m]: one bends the wire like a contact force, the other hardly."""


def check(case: Case, record: Record) -> Finding | None:
    finding = SUPPORT_PASSING.run(case, RecordSignals(record, case.file.filter))
    return None if finding.kind == "confirmed" else finding


def bumps(distance: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    return np.exp(-((distance / width) ** 2))


@pytest.fixture
def close_case(two_pantograph_case: Case) -> Case:
    """Two pantographs 40 m apart: a shift by one distance is less than 1.2 spans of 60 m."""
    return replace(two_pantograph_case, file=two_pantograph_case.file.model_copy(update={"spacing_m": (40.0,)}))


@pytest.mark.parametrize("forces", [(40.0, 160.0), (160.0, 40.0)])
def test_kink_of_the_other_pantograph_is_not_a_shift(close_case: Case, forces: tuple[float, float]) -> None:
    """The strong pantograph bends the wire four times as much, above the ratio of 2.5; there is no contact height."""
    record = Wave().record(close_case)
    distance = record.position - record.support_position[:, None, None]
    # A bump of 50 mm bends the wire like 119 N: the kinks over 1.5 m are 8.6 mm, and F L / T = 8.9 mm.
    uplift = (0.05 * np.array([[force / 119.0] for force in forces]) * bumps(distance, KINK)).sum(axis=1)
    force = np.repeat([[forces[0]], [forces[1]]], record.time.size, axis=1)
    assert check(close_case, replace(record, force=force, contact_height=None, support_uplift=uplift)) is None


@pytest.fixture
def five_supports(two_pantograph_case: Case) -> Case:
    """Analysis section of four spans: three supports are left if one or two passages do not count."""
    file = two_pantograph_case.file.model_copy(update={"evaluated_spans": (4, 7)})
    return replace(two_pantograph_case, file=file)


@pytest.fixture
def coinciding(five_supports: Case) -> Record:
    """Uplift without a kink, 40 mm to 61 mm; the heads follow it near the supports, and penetrate by force over k.

    The force at a support differs by pantograph and support, so that the penetration of up to 4 mm scatters.
    """
    record = Wave().record(five_supports)
    supports = record.support_position
    largest = 0.04 + 0.003 * (np.arange(supports.size) * 5 % 8)
    front = record.position[0] - supports[:, None]
    rear = record.position[1] - supports[:, None]
    uplift = largest[:, None] * np.maximum(bumps(front, SMOOTH), bumps(rear, SMOOTH))
    force = 119.0 + 80.0 * np.sin(np.pi * record.position / 60 / np.array([[1.7], [2.3]]))
    stiffness = np.array([[file.contact.stiffness_N_m] for file in five_supports.pantographs])
    near = np.array([largest @ bumps(x - supports[:, None], KINK) for x in record.position])
    return replace(record, force=force, contact_height=5.3 + near + force / stiffness, support_uplift=uplift)


def test_coincidence_alone_confirms_and_unclear_passages_are_named(five_supports: Case, coinciding: Record) -> None:
    assert check(five_supports, coinciding) is None
    found = check(five_supports, replace(coinciding, contact_height=None))
    assert found == report_missing(
        "the support passing check was not made: the uplift at the supports shows no clear passage of pantograph 1, 2",
    )


@pytest.mark.parametrize("row", [0, 1])
def test_without_penetration_heights_do_not_coincide(five_supports: Case, coinciding: Record, row: int) -> None:
    """Heights of the wire of one pantograph, 4 mm of penetration left out: nothing confirms its position."""
    height = coinciding.contact_height.copy()
    height[row] -= coinciding.force[row] / five_supports.pantographs[row].contact.stiffness_N_m
    found = check(five_supports, replace(coinciding, contact_height=height))
    assert found.kind == "unchecked"
    assert found.text.endswith(f"shows no clear passage of pantograph {row + 1}")


@pytest.mark.parametrize("row", [0, 1])
def test_passage_without_contact_does_not_count(five_supports: Case, coinciding: Record, row: int) -> None:
    """Without force at one support, the head of this pantograph is 0.1 m below the wire there."""
    supports = coinciding.support_position
    second = supports[supports > five_supports.analysis_section[0]][0]
    lost = np.abs(coinciding.position[row] - second) < 8.0
    force, height = coinciding.force.copy(), coinciding.contact_height.copy()
    height[row, lost] -= 0.1
    assert check(five_supports, replace(coinciding, contact_height=height)) is not None
    force[row, lost] = 0.0
    assert check(five_supports, replace(coinciding, contact_height=height, force=force)) is None


@pytest.mark.parametrize(("shift", "side"), [(12.0, "past"), (-12.0, "before"), (30.0, "past")])
@pytest.mark.parametrize("row", [0, 1])
def test_shift_and_direction(two_pantograph_case: Case, wave: type[Wave], row: int, shift: float, side: str) -> None:
    """The position of one pantograph is 12 m too large: the wire bends where it is said to be 12 m past a support."""
    # Force and height repeat in every span of 60 m, so that they coincide with the uplift at any shift, half a span
    # too.
    record = wave().record(two_pantograph_case)
    position = record.position.copy()
    position[row] += shift
    found = check(two_pantograph_case, replace(record, position=position))
    assert found.kind == "contradiction"
    assert found.text.startswith(f"the position of pantograph {row + 1} contradicts the uplift")
    assert found.text.endswith(f"when the position is {abs(shift):g} m {side} it")


@pytest.mark.parametrize(("rate", "made"), [(50.0, True), (49.0, False)])
def test_check_needs_a_rate_for_the_filter(two_pantograph_case: Case, rate: float, made: bool) -> None:
    """20 Hz are 0.4 of 50 samples per second. At 250 km/h, two samples are then 2.8 m: within the tolerance of 5 m."""
    found = check(two_pantograph_case, Wave(rate=rate).record(two_pantograph_case))
    assert (found is None) is made
    assert made or (found is not None and found.text.endswith(f"a rate of {rate:g} Hz is too low"))


# Uplift behind the active window: right or missing in the record of a case, and no reason for a skip.
UPLIFT = "max_uplift_at_support_mm"


@pytest.fixture(scope="module")
def records(case_250: Case) -> tuple[Record, Record]:
    """The case with its active window, and with the whole line active."""
    line = discretise(build_catenary(case_250.line), case_250.file.discretisation.element_m)
    windowed = build_passage(case_250, line, case_250.file.discretisation, (120.0,))
    whole = replace(windowed, kept_behind=math.inf)
    first, second = (record_passage(case_250, run, simulate_passage(line, run)) for run in (windowed, whole))
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


def test_missing_uplift_changes_no_grade(case_250: Case, records: tuple[Record, Record], tmp_path: Path) -> None:
    """The same verdict and uplift from the windowed record, from the whole one and from a written file."""
    windowed, whole = (grade_case(case_250, Delivered(record), "secondary") for record in records)
    write_record(tmp_path / "run.csv", records[0], case_250.id, further={"case_digest": case_250.digest})
    read = run_case(case_250, open_record_folder(tmp_path), "secondary")
    for result in (windowed, whole, read):
        assert result.verdict == "pass"
        assert result.record.state == "consistent"
        assert result.quantities["0"][UPLIFT] == pytest.approx(whole.quantities["0"][UPLIFT], abs=1e-6)
