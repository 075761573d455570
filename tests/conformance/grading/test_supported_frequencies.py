"""Frequencies that the files of a case support: pantograph from its source, line from closed forms."""

import math
from dataclasses import replace

import pytest

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.grading.supported_frequencies import list_case_frequencies
from pantocheck.conformance.pantograph.validity_range import SupportedRange
from pantocheck.conformance.results.supported_frequency import find_supported_Hz
from pantocheck.conformance.runs.resolution import list_mesh_frequencies, longest_element, longest_time_step


@pytest.fixture(scope="module")
def case() -> Case:
    cases = select_cases(["en50318-2018/ac-simple/320"])
    return next(case for case in cases if case.id.endswith("/320"))


def test_pantograph_without_a_source_is_not_known_and_limits_nothing(case: Case) -> None:
    rows = list(list_case_frequencies(case))
    assert [(row.part, row.limits) for row in rows] == [
        ("pantograph 1", True), ("dropper spacing", False), ("torsion of the contact wire", False)
    ]  # fmt: skip
    assert rows[0].frequency_Hz is None
    assert find_supported_Hz(rows, "1") is None


def test_stated_frequency_names_its_basis_and_source(case: Case) -> None:
    table = SupportedRange(supported_to_Hz=35.0, basis="missing_mode", source="rig report 7")
    file = case.pantographs[0].model_copy(update={"validity": table})
    row = next(list_case_frequencies(replace(case, pantographs=(file,))))
    assert (row.frequency_Hz, row.basis) == (35.0, "first missing mode: rig report 7")


def test_frequencies_of_the_line_are_closed_forms(case: Case) -> None:
    """sqrt(22 kN / 1.35 kg/m) over two spacings of 5.75 m; a bar of 109 GPa and 9000 kg/m3 over two spans of 55 m."""
    _, spacing, torsion = list_case_frequencies(case)
    assert spacing.frequency_Hz == pytest.approx(math.sqrt(22e3 / 1.35) / 11.5, rel=1e-3)
    shear = 4 * math.pi * 195 / 150e-6**2 / 2 / 1.34
    assert torsion.frequency_Hz == pytest.approx(math.sqrt(shear * 150e-6 / 1.35) / 110, rel=1e-3)
    wire = case.line.contact_wire.model_copy(update={"area_mm2": None})
    unknown = replace(case, line=case.line.model_copy(update={"contact_wire": wire}))
    assert list(list_case_frequencies(unknown))[2].frequency_Hz is None


def test_mesh_supports_a_band_where_its_warnings_begin(case: Case) -> None:
    """The frequency of a mesh is 50 Hz at the longest element and time step that give no warning for that band."""
    mesh = case.file.discretisation.model_copy(
        update={"element_m": longest_element(case.speed, 50.0), "time_step_s": longest_time_step(50.0)}
    )
    assert [row.frequency_Hz for row in list_mesh_frequencies(case, mesh)] == pytest.approx([50.0, 50.0], rel=1e-3)
