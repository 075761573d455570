"""Transfer function from a measured response: poles and residues, passivity, and the file of the command."""

from pathlib import Path

import numpy as np
import pytest

from helpers.command_line import pantocheck
from helpers.response_records import (
    FREQUENCY,
    add_noise,
    apparent_mass_columns,
    chain_stiffness,
    read_pantograph,
    write_response,
)
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.pantograph.chain_problem import MeasuredStiffness
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import head_receptance
from pantocheck.conformance.pantograph.transfer_function import find_activity, fit_transfer_function, receptance

OMEGA = 2 * np.pi * FREQUENCY


def measured(stiffness: np.ndarray) -> MeasuredStiffness:
    return MeasuredStiffness(FREQUENCY, stiffness, np.full((2, FREQUENCY.size), 100.0))


def test_receptance_of_a_chain_is_found_exactly() -> None:
    """Three masses have three pairs of poles; what remains is rounding."""
    stiffness = chain_stiffness(read_pantograph())
    found = fit_transfer_function(measured(stiffness), 3)
    np.testing.assert_allclose(receptance(found.pole, found.residue, OMEGA) * stiffness, 1.0, atol=1e-9)
    assert (found.pole.real < 0).all()
    assert found.distance == 0.0
    assert fit_transfer_function(measured(stiffness), 2).deviation > 0.01


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_noisy_fit_is_stable_and_passive(seed: int) -> None:
    """1 % and 0.5 degrees of noise: the mean deviation is that of the noise, 1.3 %, and the fit is nearer."""
    stiffness = chain_stiffness(read_pantograph())
    found = fit_transfer_function(measured(add_noise(stiffness, seed=seed)), 4)
    assert not find_activity(found.pole, found.residue).size
    assert found.deviation < 0.025
    error = np.abs(receptance(found.pole, found.residue, OMEGA) * stiffness - 1)
    assert np.sqrt(np.mean(error**2)) < found.deviation


def test_active_response_becomes_the_nearest_passive_model() -> None:
    """A negative damper in the head delivers energy: the distance says by how much the fit was changed."""
    stiffness = chain_stiffness(read_pantograph()) - 1j * OMEGA * 60.0
    found = fit_transfer_function(measured(stiffness), 3)
    assert found.distance > 0.01
    assert not find_activity(found.pole, found.residue).size


def test_command_writes_a_pantograph_file_with_its_frequency(tmp_path: Path) -> None:
    stiffness = chain_stiffness(read_pantograph())
    table = write_response(tmp_path, apparent_mass_columns(add_noise(stiffness, seed=3)))
    out = tmp_path / "head.toml"
    result = pantocheck("pantograph", "fit", str(table), "--pole-pairs", "3", "--out", str(out))
    assert result.exit_code == 0, result.output
    assert "Transfer function of 6 poles fitted" in result.output
    file = read_model(out, PantographFile, "pantograph")
    np.testing.assert_allclose(head_receptance(file, OMEGA) * stiffness, 1.0, atol=0.06)
    assert file.validity is not None
    assert (tmp_path / "head-fit.json").is_file()
    refused = pantocheck("pantograph", "fit", str(table), "--pole-pairs", "3", "--masses", "3", "--out", str(out))
    assert refused.exit_code == 2


def test_too_few_rows_are_refused() -> None:
    data = measured(chain_stiffness(read_pantograph()))
    with pytest.raises(InputError, match="values"):
        fit_transfer_function(data.select_rows(np.arange(8)), 3)
