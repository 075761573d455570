"""Fit of a chain to measured responses: closed forms, published pantographs, intervals, choice of masses."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from helpers.response_records import (
    FREQUENCY,
    add_noise,
    apparent_mass_columns,
    chain_stiffness,
    read_pantograph,
    write_response,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.chain_fit import (
    ChainFit,
    FitTask,
    compute_intervals,
    fit_chain,
    fit_chains,
    information_criterion,
    judge_parameters,
)
from pantocheck.conformance.pantograph.chain_problem import ChainProblem, MeasuredStiffness, chain_response
from pantocheck.conformance.pantograph.chain_starts import expand_chain, fit_rational_response
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.pantograph.response_record import ResponseRecord, read_response
from pantocheck.model.description.pantograph import frequencies

PANTOGRAPHS = [
    "en50318-2018/pantograph.toml",
    "en50318-2002/pantograph.toml",
    "pantographs/dsa380.toml",
    "pantographs/dsa250.toml",
]
S = 2j * np.pi * FREQUENCY
EVERY_ROW = (0.0, np.inf)
NOISE, PHASE_NOISE_DEG = 0.01, 0.5
"""Standard deviations of `add_noise`."""


def chain_values(pantograph: PantographFile) -> NDArray[np.float64]:
    """Masses, stiffnesses and dampings."""
    chain = pantograph.chain
    return np.array([chain.masses_kg, chain.stiffness_N_m, chain.damping_N_s_m])


def measure(
    pantograph: PantographFile, seed: int | None, frequency: NDArray[np.float64] = FREQUENCY
) -> MeasuredStiffness:
    """Response with noise, and its weights; without a seed, the exact response."""
    stiffness = chain_stiffness(pantograph, frequency)
    weight = np.array([[1 / NOISE], [1 / np.radians(PHASE_NOISE_DEG)]]) * np.ones(frequency.size)
    return MeasuredStiffness(frequency, stiffness if seed is None else add_noise(stiffness, seed), weight)


def free(masses: int) -> NDArray[np.float64]:
    """No fixed value."""
    return np.full((3, masses), np.nan)


def record(folder: Path, pantograph: PantographFile, name: str = "measured", **sidecar: Any) -> ResponseRecord:
    """Record with noise; its uncertainty is stated unless None is given."""
    stated = {"modulus_uncertainty_pct": 196 * NOISE, "phase_uncertainty_deg": 1.96 * PHASE_NOISE_DEG} | sidecar
    columns = apparent_mass_columns(add_noise(chain_stiffness(pantograph), seed=5))
    return read_response(write_response(folder, columns, name, **stated))


@pytest.mark.parametrize("path", PANTOGRAPHS)
def test_response_of_a_chain_is_that_of_springs_in_series(path: str) -> None:
    pantograph = read_pantograph(path)
    response = chain_response(chain_values(pantograph), S)
    assert response.stiffness == pytest.approx(chain_stiffness(pantograph), rel=1e-12)
    assert response.motion[-1] == pytest.approx(np.ones(S.size))


def test_derivatives_are_those_of_central_differences() -> None:
    """Steps of 1e-6: truncation 1e-12, rounding 1e-10 of derivatives of order one."""
    values = chain_values(read_pantograph())
    problem = ChainProblem(measure(read_pantograph(), seed=1), free(3))
    parameters = problem.pack(values)
    for column, derivative in enumerate(problem.jacobian(parameters).T):
        step = 1e-6 * np.maximum(np.abs(parameters), 1e-3) * (np.arange(parameters.size) == column)
        difference = problem.residuals(parameters + step) - problem.residuals(parameters - step)
        assert derivative == pytest.approx(difference / (2 * step[column]), rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("path", PANTOGRAPHS)
def test_frequencies_with_free_and_fixed_head_determine_the_undamped_chain(path: str) -> None:
    """Frequencies of the matrices, expanded into masses and springs; the base spring of 0.1 N/m loses five digits."""
    pantograph = read_pantograph(path)
    masses, stiffness, _ = chain_values(pantograph)
    model = build_pantograph(pantograph, 0.0, 0.0)
    fixed = frequencies(
        type(model)(
            model.mass[:-1, :-1], model.damping[:-1, :-1], model.stiffness[:-1, :-1], model.head[:-1],
            model.force[:-1], 0.0, 1.0,
        )
    )  # fmt: skip
    squared = [(2 * np.pi * values) ** 2 for values in (frequencies(model), fixed)]
    found = expand_chain(masses[-1], *squared)
    assert found[0] == pytest.approx(masses, rel=1e-7)
    assert found[1] == pytest.approx(stiffness, rel=1e-7, abs=1e-5)


def test_rational_response_of_exact_data_has_the_frequencies_of_the_chain() -> None:
    """With damping, the products of conjugate roots differ from the undamped frequencies by the coupling of modes."""
    pantograph = read_pantograph("pantographs/dsa250.toml")
    rational = fit_rational_response(FREQUENCY, chain_stiffness(pantograph), 3)
    head_mass = rational.numerator[-1] / rational.reference**2
    assert head_mass == pytest.approx(7.51, rel=1e-6)
    found = rational.reference * np.sqrt(rational.free_head) / (2 * np.pi)
    assert found == pytest.approx(frequencies(build_pantograph(pantograph, 0.0, 0.0)), rel=0.02)


@pytest.mark.parametrize("path", PANTOGRAPHS)
def test_exact_response_gives_its_chain(path: str) -> None:
    """Published pantographs: 1e-5 of each value, or 1e-3 N/m and N s/m where it is zero or nearly."""
    pantograph = read_pantograph(path)
    truth = chain_values(pantograph)
    fit = fit_chain(measure(pantograph, seed=None), free(truth.shape[1]))
    assert fit.values == pytest.approx(truth, rel=1e-5, abs=1e-3)


@pytest.mark.parametrize(
    ("frequency", "noise"),
    [(np.geomspace(0.5, 20, 40), 0.03), (np.arange(0.5, 50.01, 0.25), 0.03), (np.arange(0.5, 50, 0.02), 0.01)],
)
def test_weak_mode_is_found_in_noise_and_between_linear_rows(frequency: NDArray[np.float64], noise: float) -> None:
    """The third mode moves the head little: the best minimum has a variance ratio of 1, that of two masses 1.9 to 6."""
    pantograph = read_pantograph()
    weight = np.array([[1 / noise], [1 / np.radians(50 * noise)]]) * np.ones(frequency.size)
    measured = add_noise(chain_stiffness(pantograph, frequency), 2, noise, 50 * noise)
    fit = fit_chain(MeasuredStiffness(frequency, measured, weight), free(3))
    assert fit.variance_ratio < 1.2
    assert fit.values[0] == pytest.approx(chain_values(pantograph)[0], rel=0.35)


@pytest.mark.parametrize("measurements", [3, pytest.param(8, marks=pytest.mark.thorough)])
def test_intervals_contain_the_truth(measurements: int) -> None:
    """Three masses, 9 values for each measurement of 60 rows: at least 85 % (97 % of 1800 in the benchmark)."""
    pantograph = read_pantograph()
    truth, frequency = chain_values(pantograph), np.geomspace(0.5, 50, 60)
    inside = []
    for seed in range(measurements):
        fit = fit_chain(measure(pantograph, seed, frequency), free(3))
        inside.append(np.abs(fit.values - truth) <= compute_intervals(fit, True).half_width)
    assert np.mean(inside) >= 0.85


@pytest.fixture(scope="module")
def noisy_fit() -> ChainFit:
    return fit_chain(measure(read_pantograph(), seed=1), free(3))


def test_wide_intervals_are_named(noisy_fit: ChainFit) -> None:
    """The damper of 0.1 N s/m between frame and head carries less than the noise; all other values are determined."""
    judged = judge_parameters(noisy_fit, compute_intervals(noisy_fit, True))
    assert judged == [
        ["determined"] * 3,
        ["determined"] * 3,
        ["determined", "not_distinguished_from_zero", "determined"],
    ]


def test_equal_data_give_equal_fits(noisy_fit: ChainFit) -> None:
    again = fit_chain(measure(read_pantograph(), seed=1), free(3))
    assert np.array_equal(again.values, noisy_fit.values)


def test_fixed_value_is_kept_and_narrows_the_intervals(noisy_fit: ChainFit) -> None:
    """Masses 1 and 2 are correlated: with one of them fixed, the interval of the other is several times narrower."""
    fixed = free(3)
    fixed[0, 1] = 9.0
    fit = fit_chain(measure(read_pantograph(), seed=1), fixed)
    assert fit.values[0, 1] == 9.0
    before, after = (compute_intervals(each, True).half_width[0] for each in (noisy_fit, fit))
    assert after[1] == 0
    assert after[0] < before[0] / 3


def test_size_of_unstated_noise_follows_from_the_residuals(noisy_fit: ChainFit) -> None:
    """Weights ten times too large: without a stated noise, the intervals stay; with it, they are widened."""
    data = measure(read_pantograph(), seed=1)
    wrong = fit_chain(MeasuredStiffness(data.frequency, data.stiffness, 10 * data.weight), free(3))
    right = compute_intervals(noisy_fit, False).half_width
    assert compute_intervals(wrong, False).half_width == pytest.approx(right, rel=1e-3)
    assert compute_intervals(wrong, True).half_width == pytest.approx(right, rel=1e-3)
    assert wrong.variance_ratio == pytest.approx(100 * noisy_fit.variance_ratio, rel=1e-6)


@pytest.mark.parametrize(("path", "masses"), [("en50318-2018/pantograph.toml", 3), ("en50318-2002/pantograph.toml", 2)])
def test_number_of_masses_is_found(tmp_path: Path, path: str, masses: int) -> None:
    selection = fit_chains([record(tmp_path, read_pantograph(path))], FitTask(EVERY_ROW, None))
    assert (selection.best, selection.is_noise_stated) == (masses, True)
    assert selection.fits[masses].variance_ratio == pytest.approx(1, abs=0.3)


def test_information_criterion_weighs_residuals_against_parameters() -> None:
    """By hand: 100 ln(1 / 100) + 4 ln 100 = -96 ln 100, for 100 residuals whose squares add up to 1."""
    fit: Any = SimpleNamespace(size=100, sum_of_squares=1.0, free_count=4)
    assert information_criterion(fit) == pytest.approx(-96 * np.log(100), rel=1e-15)


def test_responses_are_joined_in_the_band(tmp_path: Path) -> None:
    """Two load levels of 120 rows, of which 96 lie from 1 to 40 Hz; one of them states no uncertainty."""
    pantograph = read_pantograph()
    stated = record(tmp_path, pantograph, "stated")
    silent = record(tmp_path, pantograph, "silent", modulus_uncertainty_pct=None, phase_uncertainty_deg=None)
    selection = fit_chains([stated, silent], FitTask((1.0, 40.0), free(3)))
    inside = int(((FREQUENCY >= 1) & (FREQUENCY <= 40)).sum())
    assert list(selection.fits) == [3]
    assert selection.is_noise_stated is False
    data = selection.fits[3].problem.data
    assert data.frequency.size == 2 * inside
    assert np.ptp(data.weight) == 0


def test_response_of_a_strip_and_short_responses_are_refused(tmp_path: Path) -> None:
    strip = record(tmp_path, read_pantograph(), "strip", measured_at="left_strip")
    with pytest.raises(InputError, match=r"'strip\.csv': is not a response of the centre of the head"):
        fit_chains([strip], FitTask(EVERY_ROW, None))
    with pytest.raises(InputError, match="have 2 values from 10 to 11 Hz"):
        fit_chains([record(tmp_path, read_pantograph())], FitTask((10.0, 11.0), None))
