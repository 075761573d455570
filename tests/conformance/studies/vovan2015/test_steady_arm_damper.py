"""Damping gained by dampers at the steady arms: fades with frequency; other dampers are caught."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from helpers.computed_modes import ELEMENT, verdicts
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.quantities.evaluation import LINE
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.studies.vovan2015.steady_arm_damper import damping_gains
from pantocheck.model import Kind, Rayleigh, discretise
from pantocheck.model.modal.modes import compute_modes_below, damping_ratios


@pytest.fixture(scope="module")
def case():
    (found,) = select_cases(["vovan2015/steady-arm-damper"])
    return found


@pytest.fixture(scope="module")
def verdicts_of(case):
    """Verdicts for a line that takes the damped one's place, by quantity and band."""
    plain = build_catenary(case.line)
    mesh = discretise(plain, ELEMENT)
    shapes = compute_modes_below(mesh, case.file.study.bands_Hz[-1][1])

    def medians(line):
        ratio = damping_ratios(discretise(line, ELEMENT), shapes)
        inside = [(shapes.frequency >= low) & (shapes.frequency < high) for low, high in case.file.study.bands_Hz]
        return [float(np.median(ratio[band])) for band in inside]

    def verdicts_for(change):
        rows = verdicts(case, {LINE: damping_gains(medians(plain), medians(change(plain)))})
        return {(name.removeprefix("damping_gain_"), band): row.verdict for (name, band), row in rows.items()}

    return verdicts_for


def dampers(damper):
    return lambda line: replace(line, steady_arms=tuple(replace(a, vertical_damper=damper) for a in line.steady_arms))


def test_gains_by_hand():
    found = damping_gains([0.002, 0.004, 0.003], [0.003, 0.006, 0.003])
    assert_allclose(found["damping_gain_pct"], [50, 50, 0], atol=1e-9)
    assert_allclose(found["damping_gain_fading_pct"], 50)


def test_a_band_without_modes_ends_the_list():
    found = damping_gains([0.002, np.nan, 0.003], [0.003, 0.006, 0.003])
    assert_allclose(found["damping_gain_pct"], [50])
    assert "damping_gain_fading_pct" not in found


def test_computed_damping_shows_what_the_paper_saw(verdicts_of, case):
    """First group and last band are left to the certificate: their printed words leave the size open."""
    found = verdicts_of(dampers(case.file.study.damper_N_s_m))
    assert [found["pct", band] for band in range(2, 7)] == ["pass"] * 5
    assert found["fading_pct", None] == "pass"
    assert found["pct", 9] == "pass"


def test_without_a_damper_nothing_is_gained(verdicts_of):
    found = verdicts_of(lambda line: line)
    assert [found["pct", band] for band in range(2, 7)] == ["fail"] * 5
    assert found["pct", 9] == "pass"


def test_damping_gained_everywhere_is_not_the_steady_arms(verdicts_of):
    """Twice the damping of both wires: no band is left alone."""
    found = verdicts_of(lambda line: replace(line, damping={k: Rayleigh(0.2, 2e-4) for k in Kind}))
    assert found["pct", 9] == "fail"


def test_damping_that_grows_with_frequency_does_not_fade(verdicts_of):
    found = verdicts_of(lambda line: replace(line, damping={k: Rayleigh(0.1, 5e-4) for k in Kind}))
    assert found["fading_pct", None] == "fail"
