"""Working height: one convention for a chain and for the same pantograph given by matrices or modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from helpers.listed_spans import list_spans
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import MatricesTable, ModesTable, PantographFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.runs.case_run import build_passage
from pantocheck.model import discretise, simulate_passage
from pantocheck.model.description.pantograph import equilibrium

UPLIFT_FORCE = 150.0
PROVENANCE = {"trust": "primary", "source": "rig"}


@pytest.fixture(scope="module")
def chain() -> PantographFile:
    """Pantograph of EN 50318:2018 with dampers proportional to its springs, which modes can represent."""
    file = read_model(library_folder() / "en50318-2018" / "pantograph.toml", PantographFile, "pantograph")
    dampers = tuple(1e-3 * k for k in file.chain.stiffness_N_m)
    return file.model_copy(update={"chain": file.chain.model_copy(update={"damping_N_s_m": dampers})})


@pytest.fixture(scope="module")
def descriptions(chain: PantographFile) -> dict[str, PantographFile]:
    """The chain, the same pantograph by its matrices, and by its modes; the uplift force acts on the lowest mass."""
    model = build_pantograph(chain, 0.0, 0.0)
    w2, shapes = eigh(model.stiffness, model.mass)
    omega = np.sqrt(w2)
    rows = {
        key: tuple(map(tuple, matrix.tolist()))
        for key, matrix in (
            ("mass_kg", model.mass),
            ("damping_N_s_m", model.damping),
            ("stiffness_N_m", model.stiffness),
        )
    }
    matrices = MatricesTable(**rows, head=(0.0, 0.0, 1.0), uplift_force_on=(1.0, 0.0, 0.0), **PROVENANCE)
    modes = ModesTable(
        frequency_Hz=tuple((omega / (2 * np.pi)).tolist()),
        damping_ratio=tuple((1e-3 * omega / 2).tolist()),
        head_shape=tuple(shapes[2].tolist()),
        uplift_force_on=tuple(shapes[0].tolist()),
        **PROVENANCE,
    )
    return {
        "chain": chain,
        "matrices": chain.model_copy(update={"chain": None, "matrices": matrices}),
        "modes": chain.model_copy(update={"chain": None, "modes": modes}),
    }


def simulate(case: Case, file: PantographFile) -> np.ndarray:
    """Contact force of an untuned passage over two spans of the line of EN 50318:2002."""
    short = case.line.model_copy(update={"geometry": case.line.geometry.shorten(4)})
    sections = {"evaluated_spans": (2, 3), "run_out_m": 0.0}
    case = replace(case, line=short, pantographs=(file,), file=case.file.model_copy(update=sections))
    line = discretise(build_catenary(short), 2.0)
    discretisation = case.file.discretisation.model_copy(update={"element_m": 2.0, "time_step_s": 2e-3})
    return simulate_passage(line, build_passage(case, line, discretisation, (UPLIFT_FORCE,))).force[0]


def test_chain_matrices_and_modes_have_one_mean_force(case_250: Case, descriptions: dict[str, PantographFile]) -> None:
    """One linear system: equal to the convergence of the contact forces, 1e-9 N per step, hence 1e-5 N in a run.

    Without the point of the uplift force, it acts on the head: 160 N/m times the compression of the head springs,
    31 mm, that is 5 N less on the base spring; on a flexible line 4.5 N remain.
    """
    forces = {name: simulate(case_250, file) for name, file in descriptions.items()}
    for force in forces.values():
        assert np.abs(force - forces["chain"]).max() < 1e-5
    table = descriptions["matrices"].matrices.model_copy(update={"uplift_force_on": None})
    on_head = simulate(case_250, descriptions["matrices"].model_copy(update={"matrices": table}))
    assert on_head.mean() - forces["chain"].mean() == pytest.approx(4.5, abs=0.5)


@pytest.mark.parametrize("name", ["chain", "matrices", "modes"])
def test_static_contact_force_at_the_working_height(descriptions: dict[str, PantographFile], name: str) -> None:
    """Base spring k1 in series with the others: F = F0 (1/k1) / (1/k1 + 1/k2 + 1/k3) at zero displacement."""
    file = descriptions[name]
    pantograph = build_pantograph(file, UPLIFT_FORCE, 0.06)
    _, contact = equilibrium(pantograph, 0.06)
    expected = UPLIFT_FORCE / 160 / (1 / 160 + 1 / 15500 + 1 / 7000)
    assert contact == pytest.approx(expected, rel=1e-9)


def test_wrong_number_of_values_is_refused(descriptions: dict[str, PantographFile]) -> None:
    table = descriptions["matrices"].matrices.model_dump()
    with pytest.raises(ValueError, match="2 values for 3 degrees of freedom"):
        MatricesTable(**table | {"uplift_force_on": (1.0, 0.0)})


@pytest.mark.parametrize("convention", ["working_height", "wire_height"])
def test_height_of_the_line_does_not_change_the_forces(case_250: Case, chain: PantographFile, convention: str) -> None:
    """A contact wire at 5.3 m above the rail: the nominal height of the wire moves with it, in both conventions.

    To 1e-6 N; heights of 5 m leave rounding errors of 1e-15 m times 5e4 N/m, which sweeps amplify.
    """
    table = chain.chain.model_copy(update={"base_spring_unstretched": convention})
    pantograph = chain.model_copy(update={"chain": table})
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    forces = []
    for height in (0.0, 5.3):
        tables["geometry"]["contact_wire_height_m"] = height
        forces.append(simulate(replace(case_250, line=LineFile.model_validate(tables)), pantograph))
    assert np.abs(forces[1] - forces[0]).max() < 1e-6
    assert forces[0].mean() > 100.0
