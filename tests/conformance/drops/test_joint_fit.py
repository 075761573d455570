"""Joint fit of a line and its damping: planted errors are found, refuted, or named as not determined."""

from dataclasses import replace

import numpy as np
import pytest

from pantocheck.conformance.app.commands.drop_identify_command import choose_groups
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_results import FitOptions, build_damping_results
from pantocheck.conformance.drops.joint_fit import _estimate_scatter, _span_within_groups
from pantocheck.conformance.line.line_parameters import BENDING, MECHANICAL, scale_line
from pantocheck.conformance.pages.damping_page import build_damping_document
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.model import Catenary
from verification.tables.line_coverage import DAMPING, TOLERANCES, build_line, list_intervals, measure_modes

SPLIT = (1.02, 0.98)
"""Factors of the tensions of contact and messenger wire on those of the line file."""

ELEMENT = 3.0
"""Length of the elements of line and fit [m]: both have the same errors of discretisation."""


@pytest.fixture(scope="module")
def line() -> Catenary:
    return build_line()


@pytest.fixture(scope="module")
def modes(line: Catenary) -> tuple[Mode, ...]:
    """Modes of the line with both tensions wrong."""
    return measure_modes(scale_line(line, MECHANICAL[:2], SPLIT), np.random.default_rng(1), ELEMENT)


@pytest.fixture(scope="module")
def right_modes(line: Catenary) -> tuple[Mode, ...]:
    """Modes of the line as its file states it."""
    return measure_modes(line, np.random.default_rng(8), ELEMENT)


def fit(modes: tuple[Mode, ...], line: Catenary, *free: str) -> DampingResults:
    options = FitOptions(free=choose_groups(",".join(free) or "none"), tolerances=np.diag(TOLERANCES**2))
    return build_damping_results(modes, line, ELEMENT, "modes.json", options)


@pytest.fixture(scope="module")
def fitted(modes: tuple[Mode, ...], line: Catenary) -> DampingResults:
    return fit(modes, line, "tensions")


def test_wrong_tensions_are_found_and_contradict_the_line(fitted: DampingResults) -> None:
    """Errors of +2 and -2 % leave a prior of 2 % alone and are 10 standard deviations of the fit."""
    for row, true in zip(fitted.properties, SPLIT, strict=True):
        assert row.determined
        assert row.low_95 <= true <= row.high_95
        assert row.high_95 - row.low_95 < 0.015
    assert (fitted.line.state, fitted.line.differences) == ("contradicted", ())
    assert [row.fact for row in fitted.line.refuted] == [
        "tension of the contact wire",
        "tension of the messenger wire",
    ]
    assert float(fitted.line.refuted[0].record.split()[0]) == pytest.approx(1.02 * 20e3, rel=0.005)
    assert "The natural frequencies contradict the line: tension of the contact wire" in fitted.warnings[0]


def test_intervals_of_the_damping_contain_the_truth_and_the_line(fitted: DampingResults) -> None:
    """With this seed all four contain it; the covariance has one row per unknown, and the intervals follow from it."""
    factors = np.array([*SPLIT, 1.0, 1.0, 1.0, 1.0])
    assert all(low <= 1 <= high for _, low, _, high in list_intervals(fitted, factors))
    assert fitted.covariance is not None
    matrix = np.array(fitted.covariance.rows)
    assert fitted.covariance.names[:3] == (
        *("contact_wire_tension", "messenger_wire_tension"),
        "contact_wire_stiffness_coefficient",
    )
    half = [(row.high_95 - row.low_95) / 2 for row in (*fitted.properties, *fitted.coefficients)]
    ratio = np.array(half) / np.sqrt(np.diag(matrix))
    assert ratio == pytest.approx(np.full(6, 2.04), abs=0.03)  # Student's quantile of 30 degrees of freedom
    correlation = matrix[0, 1] / np.sqrt(matrix[0, 0] * matrix[1, 1])
    assert correlation < -0.5  # the sum of the tensions is known better than their difference


def test_right_line_is_not_contradicted_and_undetermined_properties_are_named(
    right_modes: tuple[Mode, ...], line: Catenary
) -> None:
    """Droppers hardly move the modes: their stiffness keeps its tolerance of 10 %."""
    results = fit(right_modes, line, "tensions", "droppers", "supports", "arms")
    assert (results.line.state, results.line.refuted) == ("unconfirmed", ())
    rows = {row.name: row for row in results.properties}
    assert list(rows) == [parameter.name for parameter in MECHANICAL]
    dropper = rows["dropper_stiffness"]
    assert not dropper.determined
    assert dropper.factor == pytest.approx(1.0, abs=0.1)
    assert (dropper.high_95 - dropper.low_95) / 2 > 0.7 * 1.96 * dropper.tolerance
    named = next(text for text in results.warnings if text.startswith("The modes do not determine"))
    assert "dropper stiffness" in named
    assert "contact wire tension" not in named
    assert all(row.explained and abs(row.mean) < 0.01 for row in results.groups)
    page = build_damping_document(results, "")
    headings = [block.heading for block in page.blocks if hasattr(block, "heading")]
    assert {"Line", "Reach of the model"} <= set(headings)


def test_line_that_is_not_free_is_contradicted_too(
    modes: tuple[Mode, ...], right_modes: tuple[Mode, ...], line: Catenary
) -> None:
    """Tensions act through the sensitivities of the modes; the fit keeps those of the file, and tells."""
    results = fit(modes, line)
    assert results.properties == ()
    assert results.line.state == "contradicted"
    assert fit(right_modes, line).line.refuted == ()


def test_a_group_that_the_wires_do_not_explain_is_named(right_modes: tuple[Mode, ...], line: Catenary) -> None:
    """Damping 4 % higher in group 3 alone is eight times the scatter of 0.5 %; no damping of wires is so selective."""
    changed = tuple(
        mode.model_copy(update={"damping_ratio": 1.04 * mode.damping_ratio}) if mode.group == 3 else mode
        for mode in right_modes
    )
    results = fit(changed, line, "tensions")
    group = {row.group: row for row in results.groups}[3]
    assert not group.explained
    assert group.mean > 0.015
    assert any("does not explain group 3" in text for text in results.warnings)


def test_bending_stiffness_is_not_taken_for_tension(line: Catenary) -> None:
    """A messenger wire 1.8 times as stiff: an exact stiffness would move both tensions out of their intervals."""
    stiff = scale_line(line, BENDING, (1.0, 1.8))
    results = fit(measure_modes(stiff, np.random.default_rng(13), ELEMENT), line, "tensions")
    assert all(row.determined for row in results.properties)
    assert all(low <= 1 <= high for _, low, _, high in list_intervals(results, np.ones(6)))
    assert results.line.refuted == ()


def test_scatter_counts_the_columns_of_the_wires() -> None:
    """Twelve modes in three groups and two columns: 500 scatters of 0.5 % beside a known noise of 0.2 %.

    A restricted likelihood is unbiased in the variance, whose mean over 500 draws of 7 degrees of freedom is known
    within 2.4 % (one standard deviation); the grid of trials is 12 % wide. Without the columns the variance is
    7 / 9 of the true one, if the residuals of the fit enter, as they do.
    """
    random = np.random.default_rng(50340)
    group, columns = np.repeat([1, 2, 3], 4), np.abs(random.standard_normal((12, 2))) + 1
    noise, basis = np.full(12, 0.002), _span_within_groups(columns, group)
    assert basis.shape == (12, 5)
    variances = []
    for _ in range(500):
        values = 0.005 * random.standard_normal(12) + noise * random.standard_normal(12)
        left = values - basis @ (basis.T @ values)
        variances.append(_estimate_scatter(left, basis, np.zeros((12, 1)), noise, 1e-4) ** 2)
    assert np.mean(variances) == pytest.approx(0.005**2, rel=0.06)


def test_columns_that_add_up_to_a_group_mean_count_once() -> None:
    """Relative columns of a fit add up to 1, so that two of them and two means span three directions."""
    random = np.random.default_rng(7)
    first = random.uniform(0.2, 0.8, 8)
    assert _span_within_groups(np.column_stack([first, 1 - first]), np.repeat([1, 2], 4)).shape == (8, 3)


def test_tolerances_decide_what_a_mode_weighs(modes: tuple[Mode, ...], line: Catenary, fitted: DampingResults) -> None:
    """Arms known to 50 % instead of 10 and 5 % widen what follows from the modes that they move."""
    options = FitOptions(tolerances=np.diag(np.array([*TOLERANCES[:4], 0.5, 0.5]) ** 2))
    vague = build_damping_results(modes, line, ELEMENT, "modes", options)
    width = [results.properties[0].high_95 - results.properties[0].low_95 for results in (fitted, vague)]
    assert width[1] > 1.1 * width[0]


def test_common_coefficients_and_unknown_groups(line: Catenary) -> None:
    """Wires simulated with equal coefficients return them together."""
    rayleigh = DAMPING[line.wires[0].kind]
    equal = replace(line, damping=dict.fromkeys(DAMPING, rayleigh))
    options = FitOptions("common", tolerances=np.diag(TOLERANCES**2))
    results = build_damping_results(
        measure_modes(equal, np.random.default_rng(12), ELEMENT), line, ELEMENT, "m", options
    )
    assert [c.kind for c in results.coefficients] == ["wires", "wires"]
    for c in results.coefficients:
        assert c.value == pytest.approx(getattr(rayleigh, f"{c.matrix}_coefficient"), rel=0.02)
    with pytest.raises(InputError, match="'masts' is not known"):
        choose_groups("tensions,masts")
