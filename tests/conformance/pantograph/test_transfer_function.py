"""Transfer functions: realisation, passivity, and a pantograph described three ways."""

from pathlib import Path

import numpy as np
import pytest
import tomli_w

from helpers.lines import DAMPED, simple_line
from helpers.response_records import read_pantograph
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph, head_receptance
from pantocheck.conformance.pantograph.transfer_function import (
    find_activity,
    find_nearest_passive,
    receptance,
    relative_distance,
)
from pantocheck.model import Passage, discretise, simulate_passage
from pantocheck.model.description.pantograph import Pantograph, equilibrium, state_space

OMEGA = 2 * np.pi * np.geomspace(0.05, 80.0, 60)


def poles_of(model: Pantograph) -> tuple[np.ndarray, np.ndarray]:
    """Poles and residues of the receptance at the head."""
    matrix, drive, head = state_space(model)
    pole, vector = np.linalg.eig(matrix)
    residue = (head @ vector) * np.linalg.solve(vector, drive[:, 0])
    kept = pole.imag >= 0
    return pole[kept], np.where(pole.imag[kept] == 0, residue[kept].real, residue[kept])


def describe(chain: PantographFile, form: str) -> PantographFile:
    """The same pantograph by its modes or by its receptance; all springs proportional to their dampers."""
    model, content = build_pantograph(chain, 1.0, 0.0), chain.model_dump(exclude={"chain"})
    if form == "modes":
        values, shapes = np.linalg.eigh(
            np.linalg.solve(np.sqrt(model.mass), model.stiffness) / np.sqrt(model.mass.diagonal())
        )
        shapes = shapes / np.sqrt(model.mass.diagonal())[:, None]
        damping = (shapes.T @ model.damping @ shapes).diagonal()
        table = {
            "frequency_Hz": np.sqrt(values) / (2 * np.pi),
            "damping_ratio": damping / (2 * np.sqrt(values)),
            "head_shape": shapes[-1],
            "uplift_force_on": shapes[0],
        }
        content["modes"] = {key: tuple(map(float, value)) for key, value in table.items()}
    else:
        pole, residue = poles_of(model)
        pairs = {"poles_1_s": pole, "residues_m_N_s": residue}
        # Force at the head that holds it where every spring is without force, under a unit uplift force.
        content["transfer_function"] = {
            **{key: tuple((float(v.real), float(v.imag)) for v in value) for key, value in pairs.items()},
            "uplift_factor": float(equilibrium(model, 0.0)[1][0]),
        }
    return PantographFile.model_validate({key: value for key, value in content.items() if value is not None})


@pytest.fixture(scope="module")
def chain() -> PantographFile:
    """Library pantograph with dampers proportional to its springs: only then have its modes damping ratios."""
    file = read_pantograph()
    assert file.chain is not None
    damping = tuple(2e-3 * k for k in file.chain.stiffness_N_m)
    return file.model_copy(update={"chain": file.chain.model_copy(update={"damping_N_s_m": damping})})


def test_three_descriptions_give_the_same_record(chain: PantographFile) -> None:
    """Two pantographs through slack droppers and losses of contact: equal within 1e-6 of the force."""
    line = discretise(simple_line(4, 50.0, (5.0, 15.0, 25.0, 35.0, 45.0), DAMPED), 1.0)
    histories = []
    for form in ("chain", "modes", "transfer function"):
        file = chain if form == "chain" else describe(chain, form)
        models = tuple(build_pantograph(file, force, 0.05) for force in (260.0, 220.0))
        histories.append(simulate_passage(line, Passage(models, (70.0, 40.0), 85.0, 1.2, 1e-3)))
    first = histories[0]
    assert (first.force == 0).any()
    for history in histories[1:]:
        np.testing.assert_allclose(history.force, first.force, rtol=0, atol=1e-6 * first.force.max())
        np.testing.assert_allclose(history.height, first.height, rtol=0, atol=1e-6 * np.ptp(first.height))


def test_realisation_has_the_receptance_and_is_passive() -> None:
    """Library pantograph, whose dampers are not proportional: complex residues."""
    file = read_pantograph()
    model = build_pantograph(file, 0.0, 0.0)
    pole, residue = poles_of(model)
    assert np.abs(residue.imag).max() > 1e-3 * np.abs(residue).max()
    expected = head_receptance(file, OMEGA)
    np.testing.assert_allclose(receptance(pole, residue, OMEGA), expected, rtol=1e-9)
    np.testing.assert_allclose(head_receptance(describe(file, "transfer function"), OMEGA), expected, rtol=1e-9)
    assert find_activity(pole, residue).size == 0


def test_nearest_passive_model_of_an_active_head(tmp_path: Path) -> None:
    """A residue turned by one degree delivers energy; the correction is smaller than the turn, and is stated."""
    file = read_pantograph()
    pole, residue = poles_of(build_pantograph(file, 0.0, 0.0))
    turned = residue.copy()
    turned[-1] *= np.exp(1j * np.radians(-1.0))
    assert find_activity(pole, turned).size
    # The sign between samples counts as well: the brute force of a fine grid agrees.
    fine = 2 * np.pi * np.geomspace(0.001, 500.0, 20_000)
    assert (receptance(pole, turned, fine).imag > 0).any()
    nearest = find_nearest_passive(pole, turned)
    value = receptance(pole, nearest, fine)
    assert (value.imag <= 1e-9 * np.abs(value)).all()
    distance = relative_distance(pole, turned, nearest)
    assert 0 < distance < 2 * relative_distance(pole, turned, residue)
    content = describe(file, "transfer function").model_dump(exclude_none=True)
    table = content["transfer_function"]
    table["residues_m_N_s"] = [[v.real, v.imag] for v in turned]
    path = tmp_path / "active.toml"
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match="delivers energy at") as error:
        read_model(path, PantographFile, "pantograph")
    assert f"differs by at most {100 * distance:.2g} %" in str(error.value)
    assert "residues_m_N_s" in str(error.value)


@pytest.mark.parametrize(
    ("poles", "residues", "found"),
    [
        ([[0.5, 3.0]], [[0.0, -0.1]], "not stable"),
        ([[-0.5, 3.0]], [[0.0, -0.1], [1.0, 0.0]], "2 residues for 1 poles"),
        ([[-0.5, 0.0]], [[1.0, 0.5]], "different poles"),
    ],
)
def test_impossible_transfer_functions_are_refused(
    tmp_path: Path, poles: list[list[float]], residues: list[list[float]], found: str
) -> None:
    path, table = tmp_path / "wrong.toml", {"poles_1_s": poles, "residues_m_N_s": residues}
    content = {"title": "wrong", "contact": {"stiffness_N_m": 5e4}, "transfer_function": table}
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=found):
        read_model(path, PantographFile, "pantograph")
