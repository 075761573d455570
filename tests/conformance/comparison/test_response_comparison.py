"""Comparison of a pantograph with measured responses: closed form, heavier head, completeness, informative points."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from helpers import response_records as rig
from pantocheck.conformance.comparison.comparison_limits import RESPONSE_BANDS, ComparisonLimit
from pantocheck.conformance.comparison.response_comparison import compare_responses, model_stiffness
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.pantograph.response_record import ResponseRecord, read_response
from pantocheck.conformance.results.comparison_format import RESPONSE_QUANTITIES, ResponseComparison

PANTOGRAPHS = ["en50318-2018/pantograph.toml", "en50318-2002/pantograph.toml", "pantographs/dsa380.toml"]
REFERENCE = rig.read_pantograph()
NOISE = {"modulus_uncertainty_pct": 1.96, "phase_uncertainty_deg": 0.98}
"""95 % intervals of the noise of `add_noise`, 1 % and 0.5 degrees."""


def limit(
    upper: float = 3.0, band: tuple[float, float] = (20.0, 50.0), quantity: str = "complex_deviation_pct", **keys: Any
) -> tuple[ComparisonLimit, ...]:
    """One limit, under 70 N unless stated otherwise."""
    tables = {"quantity": quantity, "band_Hz": band, "static_forces_N": (70.0,), "upper": upper, **keys}
    return (ComparisonLimit.model_validate(tables),)


def record(folder: Path, stiffness: rig.Complex, name: str = "measured", **sidecar: Any) -> ResponseRecord:
    """Record of an apparent mass."""
    return read_response(rig.write_response(folder, rig.apparent_mass_columns(stiffness), name, **sidecar))


@pytest.mark.parametrize("path", PANTOGRAPHS)
def test_dynamic_stiffness_is_that_of_springs_and_masses_in_series(path: str) -> None:
    """Chain fraction from the base upwards, without a matrix: rounding only."""
    pantograph = rig.read_pantograph(path)
    assert model_stiffness(pantograph, rig.FREQUENCY) == pytest.approx(rig.chain_stiffness(pantograph), rel=1e-9)


def describe_otherwise(pantograph: PantographFile, model: str) -> PantographFile:
    """Same pantograph by its matrices, or by its modes without damping."""
    linear = build_pantograph(pantograph, 0.0, 0.0)
    other: dict[str, Any] = {"title": "other", "contact": {"stiffness_N_m": 5e4}}
    if model == "matrices":
        matrices = {"mass_kg": linear.mass, "damping_N_s_m": linear.damping, "stiffness_N_m": linear.stiffness}
        other["matrices"] = {name: matrix.tolist() for name, matrix in matrices.items()} | {"head": [0.0, 0.0, 1.0]}
    else:
        w2, shapes = eigh(linear.stiffness, linear.mass)
        frequency = np.sqrt(w2) / (2 * np.pi)
        other["modes"] = {
            "frequency_Hz": frequency.tolist(),
            "damping_ratio": [0.0] * 3,
            "head_shape": shapes[-1].tolist(),
        }
    return PantographFile.model_validate(other)


@pytest.mark.parametrize("model", ["matrices", "modes"])
def test_matrices_and_modes_give_the_curve_of_the_chain(tmp_path: Path, model: str) -> None:
    """Modes of the undamped chain: the modes of a pantograph file are those of proportional damping."""
    chain = REFERENCE.chain
    if model == "modes":
        chain = chain.model_copy(update={"damping_N_s_m": (0.0, 0.0, 0.0)})
    pantograph = REFERENCE.model_copy(update={"chain": chain})
    other = describe_otherwise(pantograph, model)
    assert model_stiffness(other, rig.FREQUENCY) == pytest.approx(model_stiffness(pantograph, rig.FREQUENCY), rel=1e-9)
    measured = record(tmp_path, rig.chain_stiffness(REFERENCE))
    first, second = (compare_responses([measured], each).responses[0] for each in (pantograph, other))
    assert second.model.modulus == pytest.approx(first.model.modulus, rel=1e-7)
    assert second.model.phase_deg == pytest.approx(first.model.phase_deg, abs=1e-5)


@pytest.mark.parametrize("kind", ["apparent_mass", "receptance"])
def test_known_deviation_has_the_same_size_in_every_kind(tmp_path: Path, kind: str) -> None:
    """Ten percent and five degrees everywhere: RMS and largest deviation are equal."""
    measured = rig.chain_stiffness(REFERENCE) * 1.1 * np.exp(1j * np.radians(5.0))
    columns = rig.apparent_mass_columns(measured) if kind == "apparent_mass" else rig.polar_columns(1 / measured, "m_N")
    response = read_response(rig.write_response(tmp_path, columns, kind=kind))
    compared = compare_responses([response], REFERENCE).responses[0]
    percent, degrees = 100 * np.log(1.1), 5.0
    expected = (percent, degrees, np.hypot(percent, 100 * np.radians(degrees)), percent, degrees)
    stated = read_response(rig.write_response(tmp_path, columns, "stated", kind=kind, **NOISE))
    shares = [band.beyond_uncertainty_pct for band in compare_responses([stated], REFERENCE).responses[0].bands]
    assert shares == pytest.approx([100.0] * 3)
    for band in compared.bands:
        assert [band.deviations[name] for name in RESPONSE_QUANTITIES] == pytest.approx(expected, rel=1e-7)
    assert compared.modulus_deviation_pct[7] == pytest.approx(-percent)
    assert compared.phase_deviation_deg[7] == pytest.approx(-degrees)


def test_deviation_does_not_depend_on_the_spacing_of_rows(tmp_path: Path) -> None:
    """The deviation of a 5 % heavier head over 20-50 Hz, with logarithmic and linear rows."""
    heavier = rig.scale_head(REFERENCE, 1.05)
    values = []
    for name, frequency in (("log", rig.FREQUENCY), ("linear", np.arange(0.5, 50.01, 0.05))):
        columns = rig.apparent_mass_columns(rig.chain_stiffness(heavier, frequency), frequency)
        response = read_response(rig.write_response(tmp_path, columns, name))
        bands = compare_responses([response], REFERENCE).responses[0].bands
        values.append([band.deviations["complex_deviation_pct"] for band in bands])
    assert values[0] == pytest.approx(values[1], rel=0.01)


@pytest.mark.parametrize("path", PANTOGRAPHS)
@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "pass"), (1.05, "fail"), (0.95, "fail")])
def test_head_of_other_mass_is_told_from_the_right_one(tmp_path: Path, path: str, factor: float, verdict: str) -> None:
    """Noise of 1 % and 0.5 degrees has an RMS of 1.3 %; above 20 Hz, 5 % of the head is 5 % of the apparent mass."""
    pantograph = rig.read_pantograph(path)
    measured = record(tmp_path, rig.add_noise(rig.chain_stiffness(rig.scale_head(pantograph, factor)), seed=1), **NOISE)
    comparison = compare_responses([measured], pantograph, limit(upper=3.0))
    assert comparison.verdict == verdict
    share = comparison.responses[0].bands[2].beyond_uncertainty_pct
    assert share is not None
    # 24 rows with two values: 5 % of them with noise alone; the modulus of nearly every row otherwise.
    assert share < 15 if factor == 1 else share > 40


def test_every_load_level_and_height_of_a_limit_must_be_measured(tmp_path: Path) -> None:
    levels = (55.0, 70.0, 90.0)
    records = [
        record(tmp_path, rig.chain_stiffness(REFERENCE), f"at-{level:g}", static_force_N=level) for level in levels
    ]
    graded = limit(static_forces_N=levels)
    assert compare_responses(records, REFERENCE, graded).verdict == "pass"
    comparison = compare_responses(records[:2], REFERENCE, graded)
    assert comparison.verdict == "skip"
    assert comparison.criteria[2].reason == "no response at the centre of the head under 90 N"
    records = [record(tmp_path, rig.chain_stiffness(REFERENCE), f"at-{h:g}", height_m=h) for h in (0.6, 1.8)]
    assert [c.where.height_m for c in compare_responses(records, REFERENCE, limit()).criteria] == [0.6, 1.8]
    comparison = compare_responses(records, REFERENCE, limit(heights_m=(0.6, 1.8, 2.4)))
    assert [criterion.verdict for criterion in comparison.criteria] == ["pass", "pass", "skip"]


def test_response_at_a_strip_or_without_limits_is_informative(tmp_path: Path) -> None:
    """A strip far from the model leaves the verdict to the centre, and its absence open."""
    centre = record(tmp_path, rig.chain_stiffness(REFERENCE), "centre")
    strip = record(tmp_path, 1.5 * rig.chain_stiffness(REFERENCE), "strip", excited_at="left_strip")
    comparison = compare_responses([centre, strip], REFERENCE, limit())
    assert comparison.verdict == "pass"
    assert [response.is_graded for response in comparison.responses] == [True, False]
    assert any("strip.csv: excited at the left strip" in text for text in comparison.warnings)
    assert compare_responses([strip], REFERENCE, limit()).verdict == "skip"
    comparison = compare_responses([record(tmp_path, rig.chain_stiffness(REFERENCE))], REFERENCE)
    assert (comparison.verdict, comparison.criteria) == ("info", ())
    assert comparison == ResponseComparison.model_validate_json(comparison.model_dump_json(by_alias=True))


@pytest.mark.parametrize(
    ("kept", "reason"),
    [
        (rig.FREQUENCY < 38, "no measured value between 36.69 and 50 Hz"),
        ((rig.FREQUENCY < 24) | (rig.FREQUENCY > 30), "no measured value between 23.97 and 30.23 Hz"),
        (rig.FREQUENCY < 5, "no measured value between 20 and 50 Hz"),
    ],
)
def test_incomplete_band_does_not_pass(tmp_path: Path, kept: Any, reason: str) -> None:
    frequency = rig.FREQUENCY[kept]
    columns = rig.apparent_mass_columns(rig.chain_stiffness(REFERENCE, frequency), frequency)
    comparison = compare_responses([read_response(rig.write_response(tmp_path, columns))], REFERENCE, limit())
    assert comparison.verdict == "skip"
    assert reason in str(comparison.criteria[0].reason)
    inside = (frequency >= 20) & (frequency <= 50)
    assert comparison.responses[0].bands[2].rows == np.count_nonzero(inside)


def test_missing_value_leaves_its_band_open(tmp_path: Path) -> None:
    """Row 115 is missing: the band of 20-50 Hz is open, the others are not."""
    columns = rig.apparent_mass_columns(rig.chain_stiffness(REFERENCE))
    columns["modulus_kg"][114] = np.nan
    response = read_response(rig.write_response(tmp_path, columns))
    verdicts = [compare_responses([response], REFERENCE, limit(band=band)).verdict for band in RESPONSE_BANDS]
    assert verdicts == ["pass", "pass", "skip"]
    compared = compare_responses([response], REFERENCE, limit())
    assert compared.criteria[0].reason == "no value in row 115"
    assert compared.responses[0].missing_rows == (115,)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sets(st.integers(0, rig.FREQUENCY.size - 1), min_size=1), st.booleans())
def test_no_removal_of_values_or_metadata_makes_a_failing_response_pass(
    tmp_path: Path, removed: set[int], stated: bool
) -> None:
    """A deviation at one row near 30 Hz fails; a table with fewer rows is refused, so that values are blanked."""
    stiffness = rig.chain_stiffness(REFERENCE)
    stiffness[105] *= 1.5
    columns = rig.apparent_mass_columns(stiffness)
    columns["modulus_kg"][sorted(removed)] = np.nan
    sidecar = NOISE if stated else {}
    try:
        response = read_response(rig.write_response(tmp_path, columns, **sidecar))
    except InputError:
        return
    graded = limit(quantity="largest_modulus_deviation_pct", upper=10.0)
    assert compare_responses([response], REFERENCE, graded).verdict in {"fail", "skip"}


def test_stated_uncertainty_marks_a_close_criterion(tmp_path: Path) -> None:
    """Deviation of 2 %, limit of 3 %, uncertainty of 1.96 % and 0.98 degrees: 2.6 % together."""
    stiffness = rig.chain_stiffness(REFERENCE) * 1.02
    comparison = compare_responses([record(tmp_path, stiffness, **NOISE)], REFERENCE, limit())
    assert comparison.verdict == "pass"
    assert comparison.criteria[0].limit_uncertainty == pytest.approx(np.hypot(1.96, 100 * np.radians(0.98)))
    assert "could reverse the verdict" in comparison.criteria[0].close[0]
    unknown = compare_responses([record(tmp_path, stiffness, "unknown")], REFERENCE, limit())
    assert (unknown.criteria[0].limit_uncertainty, unknown.criteria[0].close) == (None, [])
    assert any("states no uncertainty" in text for text in unknown.warnings)


def test_evident_error_of_unit_and_repeated_record_are_refused(tmp_path: Path) -> None:
    for factor in (1000.0, 9.80665, 1e-3):
        with pytest.raises(InputError, match=re.escape(f"{factor:.3g}") + " times that of the pantograph"):
            compare_responses([record(tmp_path, factor * rig.chain_stiffness(REFERENCE))], REFERENCE)
    measured = record(tmp_path, rig.chain_stiffness(REFERENCE))
    with pytest.raises(InputError, match=r"'measured\.csv': is given 2 times"):
        compare_responses([measured, measured], REFERENCE)


def test_model_is_supported_up_to_the_third_of_an_octave_before_a_missing_mode(tmp_path: Path) -> None:
    """A mode of the strip at 60 Hz lowers the stiffness by 1 - (f / 60)^2: 20 % at 26 Hz, in the third from 25.4 Hz."""
    stiffness = rig.chain_stiffness(REFERENCE)
    flexible = record(tmp_path, stiffness * (1 - (rig.FREQUENCY / 60) ** 2), "flexible")
    exact = record(tmp_path, stiffness, "exact")
    other = record(tmp_path, 2 * stiffness, "other", measured_at="other")
    heavy = record(tmp_path, 1.3 * stiffness, "heavy")
    assert compare_responses([flexible], REFERENCE).supported_to_Hz == pytest.approx(0.5 * 2 ** (17 / 3), rel=1e-3)
    assert compare_responses([exact], REFERENCE).supported_to_Hz == pytest.approx(50.0)
    assert compare_responses([exact, flexible], REFERENCE).supported_to_Hz == pytest.approx(25.4, abs=0.1)
    assert compare_responses([exact, other], REFERENCE).supported_to_Hz == pytest.approx(50.0)
    assert compare_responses([exact, heavy], REFERENCE).supported_to_Hz is None


def test_missing_rows_end_the_supported_range(tmp_path: Path) -> None:
    frequency = rig.FREQUENCY[(rig.FREQUENCY < 10) | (rig.FREQUENCY > 15)]
    columns = rig.apparent_mass_columns(rig.chain_stiffness(REFERENCE, frequency), frequency)
    response = read_response(rig.write_response(tmp_path, columns, "gap"))
    assert compare_responses([response], REFERENCE).supported_to_Hz == pytest.approx(0.5 * 2 ** (13 / 3), rel=1e-3)
