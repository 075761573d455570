"""Checks of records on a line whose contact wire is not equally high at its supports."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.extreme_runs import build_case, simulate
from helpers.listed_spans import list_spans
from helpers.section_lines import section_line
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.record_checks import check_record
from pantocheck.conformance.runs.support_passing import rest_heights
from pantocheck.model import discretise
from pantocheck.model.statics.elasticity import rest_height


@pytest.fixture(scope="module")
def uneven() -> Case:
    """The AC simple line on a ramp of 2 per mille from 250 m on; two supports differ in height, two in their arms.

    In span 7, the first dropper is 3 m from the support in place of 4.5 m.
    """
    tables: dict[str, Any] = list_spans(
        read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line")
    )
    geometry = tables["geometry"]
    geometry["span_list"] = geometry["span_list"][:10]
    presag = list(tables["droppers"]["presag_m"])
    near = {"x_m": [3.0, *tables["droppers"]["x_m"][1:]], "presag_m": presag}
    geometry["span_list"][6] = {"length_m": 55.0, "droppers": near}
    level = {"steady_arm": {"static_share": "level"}}
    geometry["support"] = [{"number": 5, "contact_wire_height_m": 0.015} | level, {"number": 7} | level]
    geometry["gradient"] = [{"from_m": 250.0, "to_m": 500.0, "slope": 0.002}]
    return replace(build_case(), line=LineFile.model_validate(tables))


def test_heights_at_rest_are_those_of_the_statics(uneven: Case) -> None:
    """Exact where the arm carries its share; elsewhere bending leaves 1 mm of a sag of 7 mm, alike at each support."""
    line = discretise(build_catenary(uneven.line), 0.5)
    supports = np.array(uneven.line.geometry.supports)
    exact = line.state.deflection[0, [line.mesh.station(x) for x in supports], 0]
    difference = rest_heights(uneven, supports) - exact
    np.testing.assert_allclose(difference[[4, 6]], 0.0, atol=1e-12)
    np.testing.assert_allclose(difference[[2, 3, 5, 7]], difference[2], atol=2e-4)
    assert abs(difference[2]) < 1.5e-3


def test_record_of_an_uneven_line_is_free_of_findings(uneven: Case) -> None:
    """Two pantographs; without the heights at rest, coincidence finds 15 mm. Shifted by 10 m the record is refuted."""
    record = simulate(uneven)
    supports = uneven.line.geometry.supports
    assert check_record(uneven, RecordSignals(record, uneven.file.filter, supports)) == {}
    shifted = replace(record, position=record.position + np.array([[0.0], [10.0]]))
    assert check_record(uneven, RecordSignals(shifted, uneven.file.filter, supports)) != {}


@pytest.mark.parametrize("static_share", ["none", "level"])
def test_record_of_an_irregular_line_with_tolerances_is_free_of_findings(static_share: str) -> None:
    """Irregularity of 20 mm, and droppers with 8 mm of tolerance: heights at rest are known at level arms only.

    The heights that the check of coincidence subtracts are those of the statics, or unknown.
    """
    tables: dict[str, Any] = read_toml(library_folder() / "en50318-2018" / "ac-simple" / "line.toml", "line")
    tables["geometry"]["spans"] = 10
    tables["steady_arm"]["static_share"] = static_share
    heights = [0.0, 0.02, -0.02, 0.015, -0.01, 0.02, -0.015, 0.0]
    tables["contact_wire"]["irregularity"] = {"x_m": [80.0 * n for n in range(8)], "height_m": heights}
    droppers = {"tolerance_m": 0.008, "seed": 1}
    tables["variation"] = {"droppers": droppers} if static_share == "none" else {}
    case = replace(build_case(), line=LineFile.model_validate(tables))
    supports = case.line.geometry.supports
    found = rest_heights(case, np.array(supports))
    if static_share == "none":
        assert np.isnan(found).all()
    else:
        exact = rest_height(discretise(build_catenary(case.line), 0.5), np.array(supports))
        np.testing.assert_allclose(found, exact, atol=1e-9)
    record = simulate(case)
    assert check_record(case, RecordSignals(record, case.file.filter, supports)) == {}


@pytest.fixture(scope="module")
def overlapping() -> Case:
    """Two sections of AC simple with an overlap of spans 5 and 6; at support 5 both contact wires are 60 mm up."""
    overlap = {"spans": 2, "support_rises_m": [0.4, 0.06]}
    return replace(build_case(), line=section_line("en50318-2018/ac-simple", (6, 6), overlap))


def test_heights_at_rest_in_an_overlap_are_those_of_the_lowest_wire(overlapping: Case) -> None:
    """At support 5, 275 m, both wires; at the others that wire which is not raised. Bending: 1 mm, as above."""
    line = discretise(build_catenary(overlapping.line), 0.5)
    supports = np.array(overlapping.line.geometry.supports)
    exact = rest_height(line, supports)
    np.testing.assert_allclose(rest_heights(overlapping, supports), exact, atol=1.5e-3)
    assert exact[4] > 0.05
    assert np.abs(np.delete(exact, 4)).max() < 0.01


def test_record_of_an_overlap_is_free_of_findings(overlapping: Case) -> None:
    """The heads change from wire to wire 60 mm higher than elsewhere; shifted by 10 m the record is refuted."""
    record = simulate(overlapping)
    low_pass, supports = overlapping.file.filter, overlapping.line.geometry.supports
    assert record.evaluated[0] < 275.0 < record.evaluated[1]
    assert check_record(overlapping, RecordSignals(record, low_pass, supports)) == {}
    shifted = replace(record, position=record.position + np.array([[0.0], [10.0]]))
    assert check_record(overlapping, RecordSignals(shifted, low_pass, supports)) != {}
