"""Pantographs as chain, matrices and modes: three equivalent descriptions."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.model import Passage, discretise, simulate_passage
from pantocheck.model.description.pantograph import Pantograph, apparent_mass

HEAD = 'title = "measured"\n[contact]\nstiffness_N_m = 5e4\ntrust = "primary"\nsource = "rig"\n'
PROVENANCE = 'trust = "primary"\nsource = "rig"\n'


def library_pantograph() -> PantographFile:
    return read_model(library_folder() / "en50318-2018" / "pantograph.toml", PantographFile, "pantograph")


def write_pantograph(folder: Path, text: str) -> PantographFile:
    path = folder / "pantograph.toml"
    path.write_text(HEAD + text)
    return read_model(path, PantographFile, "pantograph")


def rows(matrix: np.ndarray) -> str:
    return "[" + ", ".join(str([float(x) for x in row]) for row in matrix) + "]"


def by_matrices(folder: Path, model: Pantograph, head: tuple[float, ...] = (0, 0, 1)) -> PantographFile:
    text = f"mass_kg = {rows(model.mass)}\ndamping_N_s_m = {rows(model.damping)}\n"
    text += f"stiffness_N_m = {rows(model.stiffness)}\n"
    return write_pantograph(folder, f"[matrices]\n{text}head = {[float(x) for x in head]}\n{PROVENANCE}")


def test_matrices_repeat_the_chain_in_frequency_and_on_a_line(tmp_path: Path, case_250: Case) -> None:
    """The uplift force acts elsewhere, which a linear pantograph does not feel: the same force to rounding, 1e-6 N.

    Without a spring to the base, that is: in a chain its force follows the mass it holds, not the head.
    """
    file = library_pantograph()
    free = file.chain.model_copy(update={"stiffness_N_m": (0.0, 15500.0, 7000.0)})
    chain = build_pantograph(file.model_copy(update={"chain": free}), 150.0, 0.05)
    matrices = build_pantograph(by_matrices(tmp_path, chain), 150.0, 0.05)
    frequency = np.linspace(0.2, 50, 40)
    assert apparent_mass(matrices, frequency) == pytest.approx(apparent_mass(chain, frequency), rel=1e-9)
    geometry = case_250.line.geometry.model_copy(update={"spans": 3})
    line = discretise(build_catenary(case_250.line.model_copy(update={"geometry": geometry})), 1.0)
    first, second = (simulate_passage(line, Passage((p,), (60.0,), 60.0, 0.3, 1e-3)).force for p in (chain, matrices))
    assert np.ptp(first) > 10
    assert np.abs(first - second).max() < 1e-6


def test_modes_repeat_an_undamped_chain(tmp_path: Path) -> None:
    chain = build_pantograph(library_pantograph(), 150.0, 0.0)
    w2, shapes = eigh(chain.stiffness, chain.mass)
    text = f"frequency_Hz = {list(np.sqrt(w2) / (2 * np.pi))}\ndamping_ratio = [0.0, 0.0, 0.0]\n"
    text = text.replace("np.float64(", "").replace(")", "")
    shape = [float(x) for x in chain.head @ shapes]
    modes = build_pantograph(
        write_pantograph(tmp_path, f"[modes]\n{text}head_shape = {shape}\n{PROVENANCE}"), 150.0, 0.05
    )
    undamped = np.zeros_like(chain.damping)
    by_hand = type(chain)(chain.mass, undamped, chain.stiffness, chain.head, chain.force, 150.0, 5e4)
    frequency = np.array([0.3, 1.5, 4.0, 12.0, 30.0])
    assert apparent_mass(modes, frequency) == pytest.approx(apparent_mass(by_hand, frequency), rel=1e-9)


@pytest.mark.parametrize("model", ["matrices", "modes"])
def test_pantograph_at_working_height_presses_with_its_static_force(tmp_path: Path, model: str) -> None:
    """The bordered static system has the static force as its multiplier."""
    if model == "matrices":
        file = by_matrices(tmp_path, build_pantograph(library_pantograph(), 1.0, 0.0))
    else:
        text = "frequency_Hz = [0.9, 7.0]\ndamping_ratio = [0.2, 0.05]\nhead_shape = [0.2, 0.3]\n"
        file = write_pantograph(tmp_path, f"[modes]\n{text}{PROVENANCE}")
    pantograph = build_pantograph(file, 170.0, 0.06)
    n = pantograph.head.size
    system = np.block([[pantograph.stiffness, pantograph.head[:, None]], [pantograph.head[None], np.zeros((1, 1))]])
    solution = np.linalg.solve(system, np.append(pantograph.force, 0.06))
    assert solution[n] == pytest.approx(170.0, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "key chain: missing"),
        (
            "[modes]\nfrequency_Hz = [1.0]\ndamping_ratio = [0.1, 0.2]\nhead_shape = [0.3]\n" + PROVENANCE,
            "2 values for 1 modes",
        ),
        (
            "[matrices]\nmass_kg = [[1.0, 0.5], [0.4, 1.0]]\ndamping_N_s_m = [[0.0, 0.0], [0.0, 0.0]]\n"
            "stiffness_N_m = [[1.0, 0.0], [0.0, 1.0]]\nhead = [0.0, 1.0]\n" + PROVENANCE,
            "not symmetric",
        ),
        (
            "[matrices]\nmass_kg = [[1.0, 2.0], [2.0, 1.0]]\ndamping_N_s_m = [[0.0, 0.0], [0.0, 0.0]]\n"
            "stiffness_N_m = [[1.0, 0.0], [0.0, 1.0]]\nhead = [0.0, 1.0]\n" + PROVENANCE,
            "lowest eigenvalue is -1",
        ),
        (
            "[matrices]\nmass_kg = [[1.0]]\ndamping_N_s_m = [[0.0]]\nstiffness_N_m = [[1.0, 0.0]]\nhead = [1.0]\n"
            + PROVENANCE,
            "does not have 1 rows of 1 values",
        ),
    ],
)
def test_impossible_models_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        write_pantograph(tmp_path, text)
