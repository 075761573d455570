"""Quantities of every span at rest: against those of the middle span, and against the length of the span."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.listed_spans import list_spans
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.static_quantities import compute_quantities_along_line, compute_static_quantities
from pantocheck.model import discretise


@pytest.fixture(scope="module")
def listed() -> Case:
    """Static case of the AC simple line on five listed spans; the contact wire rises by 1 per mille over the third."""
    folder = library_folder() / "en50318-2018" / "ac-simple"
    tables = list_spans(read_toml(folder / "line.toml", "line"))
    tables["geometry"]["span_list"] = tables["geometry"]["span_list"][:5]
    tables["geometry"]["gradient"] = [{"from_m": 110.0, "to_m": 165.0, "slope": 0.001}]
    return replace(load_case(folder / "static.toml"), line=LineFile.model_validate(tables))


@pytest.fixture(scope="module")
def values(listed: Case) -> dict[str, Any]:
    return compute_quantities_along_line(listed.line, discretise(build_catenary(listed.line), 1.0))


def test_middle_span_has_the_values_of_the_static_check(listed: Case, values: dict[str, Any]) -> None:
    """The same positions and droppers of span 3 of 5, to rounding: sums of several threads have another order."""
    middle = compute_static_quantities(listed, discretise(build_catenary(listed.line), 1.0))
    for name in ("elasticity", "elasticity_200_N"):
        along = middle[f"{name}_along_span_mm_N"]
        assert values[f"{name}_along_line_mm_N"][48:72] == pytest.approx(along, rel=1e-9)
        assert values[f"{name}_of_spans_mm_N"][2] == pytest.approx(middle[f"{name}_mm_N"], rel=1e-9)
        non_uniformity = middle[f"{name}_non_uniformity_pct"]
        assert values[f"{name}_non_uniformity_of_spans_pct"][2] == pytest.approx(non_uniformity, rel=1e-9)
    assert values["presag_along_line_mm"][18:27] == middle["presag_mm"]
    assert values["dropper_length_along_line_m"][18:27] == middle["dropper_length_stagger_m"]


def test_pre_sag_counts_from_the_rising_wire(listed: Case, values: dict[str, Any]) -> None:
    """A gradient does not change the prescribed pre-sag of any span."""
    assert values["presag_along_line_mm"] == pytest.approx([1e3 * sag for sag in listed.line.droppers.presag_m] * 5)


def test_elasticity_grows_with_the_length_of_the_span() -> None:
    """Drop line with spans of 63, 63, 58.5, 63, 54 and 63 m: l / (k T) with one k for its inner spans, to 4 %.

    At an anchor the elasticity is zero, but for the compliance of a short piece of wire under the force, 1e-3 mm/N.
    """
    line = read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")
    values = compute_quantities_along_line(line, discretise(build_catenary(line), 1.0))
    largest = np.array(values["elasticity_of_spans_mm_N"])
    factor = np.array(line.geometry.span_lengths) / 35.0 / largest
    np.testing.assert_allclose(factor[1:5], factor[1:5].mean(), rtol=0.04)
    assert 3.3 < factor[1:5].mean() < 4.0
    assert values["elasticity_along_line_mm_N"][0] == pytest.approx(0.0, abs=2e-3)


def test_only_lines_with_listed_spans_have_values_of_every_span(listed: Case) -> None:
    """A static case of the reference simulator delivers them; a line of equal spans has those of its middle span."""
    coarse = listed.file.discretisation.model_copy(update={"element_m": 5.0})
    case = replace(listed, file=listed.file.model_copy(update={"discretisation": coarse}))
    delivered = ReferenceSimulator().run_unrefined(case).static
    assert len(delivered["elasticity_of_spans_mm_N"]) == 5
    equal = load_case(library_folder() / "en50318-2018" / "ac-simple" / "static.toml").line
    few = equal.model_copy(update={"geometry": equal.geometry.shorten(2)})
    assert compute_quantities_along_line(few, discretise(build_catenary(few), 5.0)) == {}
