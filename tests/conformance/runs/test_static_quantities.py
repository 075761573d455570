"""Lines at rest as the reference simulator reports them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from helpers.listed_spans import list_spans
from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.static_quantities import (
    compute_quantities_along_line,
    compute_static_quantities,
    first_modes,
    sample_span,
)
from pantocheck.model import discretise


def shortened(name: str, spans: int = 8) -> Case:
    """Case of the library on a shorter line; its ends hardly affect the middle span."""
    case = next(case for case in select_cases([name]) if case.id == name)
    sections = {} if case.is_static else {"evaluated_spans": (3, 4), "compared_spans": None}
    return change_case(case, spans, **sections)


@pytest.fixture(scope="module")
def simple() -> tuple[Case, dict[str, Any]]:
    case = shortened("en50318-2018/ac-simple/static")
    return case, compute_static_quantities(case, discretise(build_catenary(case.line), 0.5))


def test_bending_and_stagger_add_to_the_published_lengths(simple: tuple[Case, dict[str, Any]]) -> None:
    """Strings to 1 mm; bending 4 to 5 mm more; the slant of the outer droppers 11 mm on top."""
    case, found = simple
    string, bending, stagger = (
        1e3 * np.array(found[f"dropper_length{name}_m"]) for name in ("", "_bending", "_stagger")
    )
    assert string == pytest.approx(1e3 * np.array(case.line.droppers.length_m), abs=1.0)
    assert (bending - string).min() > 4.0
    assert (bending - string).max() < 5.2
    # A straight zigzag is 0.167 m aside at 4.5 m, which on 1.022 m makes 13.6 mm; the droppers draw the wires together.
    assert 10.0 < stagger[0] - bending[0] < 1e3 * (np.hypot(1.0216, 0.1673) - 1.0216)


def test_elasticity_is_symmetrical_and_larger_when_droppers_are_slack(simple: tuple[Case, dict[str, Any]]) -> None:
    _, found = simple
    small, large = (np.array(found[f"elasticity{name}_along_span_mm_N"]) for name in ("", "_200_N"))
    assert small.size == large.size == 24
    assert small[1:] == pytest.approx(small[:0:-1], rel=1e-3)
    assert (large > small - 1e-12).all()
    assert large.max() / small.min() > 1
    assert np.abs(large - small).max() > 0.01
    for name, elasticity in (("elasticity", small), ("elasticity_200_N", large)):
        lowest, highest = elasticity.min(), elasticity.max()
        assert found[f"{name}_mm_N"] == highest
        assert found[f"{name}_non_uniformity_pct"] == pytest.approx(100 * (highest - lowest) / (highest + lowest))
    assert 0.1 < small.min() < small.max() < 1.0  # [mm/N], the order of every main line
    case, found = simple
    sag = np.array(found["presag_mm"])
    assert sag.size == len(case.line.droppers.length_m) == len(found["dropper_length_m"])
    assert sag == pytest.approx(sag[::-1], abs=1e-6)
    case, found = simple
    assert len(found["apparent_mass_kg"]) == len(case.file.apparent_mass.frequency_Hz)
    assert found["apparent_mass_kg"][-1] == pytest.approx(7.5, rel=0.1)  # at 20 Hz the head is nearly alone
    # Every 2.5 m of 60 m.
    assert sample_span(120.0, 180.0) == pytest.approx(np.arange(120.0, 180.0, 2.5))


def test_modes_are_those_of_ten_spans() -> None:
    """A line of twelve spans: elements of 5 m over 10 spans; ten modes that move the wires vertically."""
    case = shortened("en50318-2018/ac-simple/static", 12)
    modes = first_modes(case.line, 5.0)
    assert modes.frequency.size == 10
    mesh = discretise(build_catenary(change_case(case, 10).line), 5.0).mesh
    assert modes.shape.shape == (10, mesh.rows, mesh.position.size, 2)
    lateral = [row for row in range(mesh.rows) if mesh.row_field[row] == "y"]
    size = (modes.shape[..., 0] ** 2).sum(axis=2)
    assert (size[:, lateral].sum(axis=1) < 0.5 * size.sum(axis=1)).all()


def test_waves_and_modes(simple: tuple[Case, dict[str, Any]]) -> None:
    case, found = simple
    assert found["wave_speed_m_s"] == pytest.approx(np.sqrt(22e3 / 1.35))
    assert "doppler_factor" not in found
    running = shortened("en50318-2018/ac-simple/320")
    factors = compute_static_quantities(running, discretise(build_catenary(running.line), 1.0))
    c, v = factors["wave_speed_m_s"], 320 / 3.6
    assert factors["doppler_factor"] == pytest.approx((c - v) / (c + v))
    assert factors["amplification_coefficient"] == pytest.approx(
        factors["reflection_coefficient"] / factors["doppler_factor"]
    )
    frequencies = np.array(found["natural_frequency_Hz"])
    assert frequencies.size == 10
    assert (np.diff(frequencies) > 0).all()
    # Both wires as one string of 38 kN and 2.43 kg/m over a span: 1.14 Hz; the group lies around it.
    assert frequencies[0] == pytest.approx(np.sqrt(38e3 / 2.43) / (2 * case.line.geometry.span_m), rel=0.25)


def test_stitched_line_fits_its_figure_and_a_failed_check_skips_its_cases() -> None:
    """Seven lengths measured to 0.01 m."""
    case = shortened("en50318-2018/ac-stitched/static")
    found = compute_static_quantities(case, discretise(build_catenary(case.line), 1.0))
    assert found["dropper_length_m"] == pytest.approx(case.line.droppers.length_m, abs=0.0101)
    static, running = (shortened(f"en50318-2018/ac-simple/{name}") for name in ("static", "275"))
    wrong = static.limits[0].model_copy(update={"lower": 2.0, "upper": 3.0})
    static = replace(change_case(static, mesh=(4.0, 1e-3)), limits=(wrong,))
    results = run_cases([static, running], ReferenceSimulator())
    assert [case.verdict for case in results.cases] == ["fail", "skip"]
    assert results.cases[1].reason == f"requires {static.id}, whose verdict is fail"


# Quantities of every span at rest: against those of the middle span, and against the length of the span.
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


def test_middle_span_has_the_values_of_the_static_check_and_its_pre_sag(listed: Case, values: dict[str, Any]) -> None:
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
    # A gradient does not change the prescribed pre-sag of any span.
    assert values["presag_along_line_mm"] == pytest.approx([1e3 * sag for sag in listed.line.droppers.presag_m] * 5)


def test_elasticity_grows_with_the_length_of_the_span() -> None:
    """Drop line with spans of 63, 63, 58.5, 63, 54 and 63 m: l / (k T) with one k for its inner spans, to 4 %."""
    # At an anchor the elasticity is zero, but for the compliance of a short piece of wire under the force, 1e-3 mm/N.
    line = read_model(library_folder() / "mass-drop-line" / "line.toml", LineFile, "line")
    values = compute_quantities_along_line(line, discretise(build_catenary(line), 1.0))
    largest = np.array(values["elasticity_of_spans_mm_N"])
    factor = np.array(line.geometry.span_lengths) / 35.0 / largest
    np.testing.assert_allclose(factor[1:5], factor[1:5].mean(), rtol=0.04)
    assert 3.3 < factor[1:5].mean() < 4.0
    assert values["elasticity_along_line_mm_N"][0] == pytest.approx(0.0, abs=2e-3)


def test_only_lines_with_listed_spans_have_values_of_every_span(listed: Case) -> None:
    """A static case of the reference simulator delivers them; a line of equal spans has those of its middle span."""
    delivered = ReferenceSimulator().run_unrefined(change_case(listed, mesh=(5.0, 1e-3))).static
    assert len(delivered["elasticity_of_spans_mm_N"]) == 5
    equal = load_case(library_folder() / "en50318-2018" / "ac-simple" / "static.toml").line
    few = equal.model_copy(update={"geometry": equal.geometry.shorten(2)})
    assert compute_quantities_along_line(few, discretise(build_catenary(few), 5.0)) == {}
