"""Modes whose half-power bands overlap take no part in a damping fit: a line of equal spans has many of them."""

import tomllib

import numpy as np
import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.drops.damping_results import build_damping_results
from pantocheck.conformance.drops.mode_matching import ModePair, find_overlapping_modes
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pages.damping_page import build_damping_document
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identified_modes import Mode, SensorShape
from pantocheck.model import Catenary, Kind, discretise
from pantocheck.model.modal.modes import compute_modes, damping_ratios, deflection_at

LINE = """
title = "Six equal spans"
geometry = { span_m = 54.0, spans = 6, encumbrance_m = 1.4, stagger_contact_wire_m = 0.2 }
contact_wire = { tension_N = 20000.0, mass_kg_m = 1.07, bending_stiffness_N_m2 = 130.0 }
messenger_wire = { tension_N = 15000.0, mass_kg_m = 0.85, bending_stiffness_N_m2 = 100.0 }
steady_arm = { static_share = "level", length_m = 1.2, mass_kg_m = 0.8, clamp_kg = 0.2 }
messenger_support = { stiffness_N_m = 500000.0, damping_N_s_m = 1000.0 }

[droppers]
x_m = [5.0, 13.8, 22.6, 31.4, 40.2, 49.0]
stiffness_N_m = 100000.0
mass_kg_m = 0.1
clamp_on_messenger_kg = 0.15
clamp_on_contact_kg = 0.15

[damping]
contact_wire = { mass_coefficient_1_s = 0.04, stiffness_coefficient_s = 6e-5 }
messenger_wire = { mass_coefficient_1_s = 0.06, stiffness_coefficient_s = 1e-4 }
droppers = { mass_coefficient_1_s = 0.0, stiffness_coefficient_s = 1e-5 }
"""
"""Six equal spans: six modes lie between 1.234 and 1.236 Hz, where the half-power bandwidth is 9 mHz."""

MODES = 56
"""Computed modes, up to 3.8 Hz."""

SENSORS = (("contact wire", "CW", 131.0), ("messenger wire", "MW", 185.0))
MIXTURE = 1.06
"""Error of the damping ratio of a pole that is a mixture of several modes; simulated tests show up to 8 %."""


@pytest.fixture(scope="module")
def line() -> Catenary:
    return build_catenary(LineFile.model_validate(tomllib.loads(LINE)))


@pytest.fixture(scope="module")
def modes(line: Catenary) -> tuple[Mode, ...]:
    """Exact modes of the line; those with another one within a half-power bandwidth have the ratio of a mixture."""
    mesh = discretise(line, 2.0, tuple(x for _, _, x in SENSORS))
    shapes = compute_modes(mesh, MODES)
    at_sensors = np.array([deflection_at(mesh, shapes, mesh.mesh.row_of[name, "z"], x) for name, _, x in SENSORS]).T
    ratio = damping_ratios(mesh, shapes)
    distance = np.abs(shapes.frequency[:, None] - shapes.frequency) + np.diag(np.full(MODES, np.inf))
    close = distance.min(axis=1) < 2 * ratio * shapes.frequency
    return tuple(
        Mode(
            frequency_Hz=frequency,
            damping_ratio=value * (MIXTURE if mixed else 1.0),
            damping_ratio_std=0.002 * value,
            group=1 + i // 8,
            sensor_shape=tuple(
                SensorShape(sensor=number, wire=wire, position_m=x, re=component, im=0.0)
                for number, ((_, wire, x), component) in enumerate(zip(SENSORS, shape, strict=True), 1)
            ),
        )
        for i, (frequency, value, shape, mixed) in enumerate(
            zip(shapes.frequency, ratio, at_sensors, close, strict=True)
        )
    )


@pytest.fixture(scope="module")
def results(modes: tuple[Mode, ...], line: Catenary) -> DampingResults:
    return build_damping_results(modes, line, 2.0, "modes.json")


def test_overlap_counts_in_half_power_bandwidths() -> None:
    """Bandwidth 10 mHz: measured modes 1 and 2 are 8 mHz apart, computed modes 5 and 6 9 mHz, all others farther."""
    measured = np.array([1.0, 1.1, 1.108, 1.3, 1.5])
    computed = np.array([1.0, 1.011, 1.1, 1.2, 1.3, 1.5, 1.509])
    pairs = [ModePair(i, j, 1.0) for i, j in ((0, 0), (1, 2), (2, 3), (3, 4), (4, 5))]
    marks = find_overlapping_modes(measured, np.full(5, 0.01), computed, pairs)
    assert marks.tolist() == [False, True, True, False, True]
    assert not find_overlapping_modes(measured[:1], np.full(1, 0.01), computed[:1], pairs[:1]).any()


def test_overlapping_modes_are_left_out_and_the_intervals_contain_the_truth(
    results: DampingResults, line: Catenary
) -> None:
    """Every other mode is exact, so that each coefficient returns within 1 %; mixtures would change them."""
    for c in results.coefficients:
        truth = getattr(line.rayleigh(Kind(c.kind)), f"{c.matrix}_coefficient")
        assert c.determined
        assert c.value == pytest.approx(truth, rel=0.01)
        assert c.low_95 * 0.999 <= truth <= c.high_95 * 1.001
    overlapping = [pair for pair in results.pairs if pair.overlapping]
    assert overlapping
    assert not any(pair.used for pair in overlapping)
    assert all(pair.used for pair in results.pairs if not pair.overlapping)


def test_page_and_warning_name_the_modes_that_are_left_out(results: DampingResults) -> None:
    overlapping = [pair for pair in results.pairs if pair.overlapping]
    warning = results.warnings[1]
    assert warning.startswith(f"{len(overlapping)} modes left out of the fit: {overlapping[0].measured_Hz:.3f}, ")
    document = build_damping_document(results, "")
    assert f"fitted to {len(results.pairs) - len(overlapping)} modes" in document.header.headline
    assert str(document).count("no: overlaps another mode") == len(overlapping)
    # The droppers give more than 1 % of some ratios: the text names the rule, the number and the subtraction.
    warning = results.warnings[2]
    assert "is subtracted from the measured damping ratios. It is more than 1 % of the damping ratio of " in warning


def test_too_few_separate_modes_are_refused(modes: tuple[Mode, ...], results: DampingResults, line: Catenary) -> None:
    close = [mode for mode, pair in zip(modes, results.pairs, strict=True) if pair.overlapping]
    with pytest.raises(InputError, match="only 0 modes for a fit of 4 coefficients"):
        build_damping_results(close, line, 2.0, "modes.json")
