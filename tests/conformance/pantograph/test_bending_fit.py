"""Bending modes of a head from its frequency response."""

from pathlib import Path

import numpy as np
import pytest

from helpers.response_records import (
    FREQUENCY,
    add_noise,
    apparent_mass_columns,
    chain_stiffness,
    read_pantograph,
    write_response,
)
from pantocheck.conformance.app.notebook.fitted_pantograph import build_fitted_pantograph
from pantocheck.conformance.pantograph.bending_fit import FittedMode
from pantocheck.conformance.pantograph.chain_fit import FitTask, fit_chains
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.pantograph.response_record import read_response

MODE = FittedMode(27.0, 0.02, 0.25)
S = 2j * np.pi * FREQUENCY


def test_bending_mode_is_found_beside_its_chain(tmp_path: Path) -> None:
    """Library pantograph with a horn at 27 Hz, 1 % and 0.5 degrees of noise: within five standard errors of 0.5 %."""
    truth = read_pantograph()
    assert truth.chain is not None
    stiffness = 1 / (1 / chain_stiffness(truth) + MODE.receptance(S))
    uncertainty = {"modulus_uncertainty_pct": 1.96, "phase_uncertainty_deg": 0.98}
    path = write_response(tmp_path, apparent_mass_columns(add_noise(stiffness, seed=3)), **uncertainty)
    records = (read_response(path),)
    # The base spring of 160 N/m is known: the band does not show it.
    fixed = np.full((3, 3), np.nan)
    fixed[1, 0] = truth.chain.stiffness_N_m[0]
    plain = fit_chains(records, FitTask((0.0, np.inf), fixed))
    selection = fit_chains(records, FitTask((0.0, np.inf), fixed, bending_modes=1))
    (found,) = selection.modes[3]
    assert found.frequency_Hz == pytest.approx(MODE.frequency_Hz, rel=5e-3)
    assert found.shape == pytest.approx(MODE.shape, rel=0.05)
    assert found.damping_ratio == pytest.approx(MODE.damping_ratio, rel=0.2)
    assert selection.fits[3].values[0] == pytest.approx(truth.chain.masses_kg, rel=0.05)
    assert plain.fits[3].variance_ratio > 3 * selection.fits[3].variance_ratio
    file = build_fitted_pantograph(records, selection, 3, "fitted", 5e4)
    written = PantographFile.model_validate(file.tables)
    deviation = np.log(head_receptance(written, S.imag) * stiffness)
    assert np.abs(deviation).max() < 0.03
    assert any("bending mode at 27 Hz" in warning for warning in file.report.warnings)
