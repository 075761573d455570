"""FMUs in processes of their own: whatever they do, the suite gives one reason."""

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.fmu_fixtures import WriteFmu
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.pantograph.fmu_table import FmuTable
from pantocheck.conformance.runs import fmu_process
from pantocheck.conformance.runs.fmu_process import (
    FmuFacts,
    FmuFailed,
    FmuPantograph,
    describe_coupling,
    find_scale,
    open_fmu,
)
from pantocheck.model.dynamics.passage import Coupling

VALUES = {"uplift_force_N": 120.0, "train_speed_km_h": 250.0, "base_height_m": 0.0}


def advance(fmu: FmuPantograph, steps: int) -> None:
    for _ in range(steps):
        fmu.attempt(np.array([120.0]))
        fmu.accept()


def table_of(write_fmu: WriteFmu, **keys: object) -> FmuTable:
    table = write_fmu(**keys).fmu
    assert table is not None
    return table


@pytest.mark.parametrize(("interface", "version"), [("co-simulation", 2), ("model-exchange", 3)])
def test_heights_answer_to_forces_in_si_units(write_fmu: WriteFmu, interface: str, version: int) -> None:
    """A head of 7.2 kg falls by F dt^2 / 2m in a step: 0.0695 um/N at 1 ms; the midpoint rule has half, by its mean."""
    with open_fmu(table_of(write_fmu, interface=interface, version=version), VALUES, 1e-3, 0.25) as fmu:
        first, second = fmu.attempt(np.array([100.0])), fmu.attempt(np.array([110.0]))
        assert first[0] == pytest.approx(0.25, abs=0.1)
        assert (first - second)[0] == pytest.approx(10 * 1e-6 / (2 * 7.2), rel=2e-3)
        again = fmu.attempt(np.array([100.0]))
        assert np.array_equal(first, again)


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("crash", "was ended by SIGSEGV before it answered"),
        ("abort", "failed at 'step': fmi2DoStep failed with status 3"),
        ("hang", "gave no answer within 0.5 s"),
        ("not a number", "must be finite numbers"),
        ("memory", "was ended by SIGSEGV before it answered"),
    ],
)
def test_a_failure_of_the_code_is_one_reason(
    write_fmu: WriteFmu, monkeypatch: pytest.MonkeyPatch, fault: str, reason: str
) -> None:
    monkeypatch.setattr(fmu_process, "STEP_LIMIT", 0.5 if fault == "hang" else 10.0)
    with (
        pytest.raises(FmuFailed, match=reason),
        open_fmu(table_of(write_fmu, fault=fault), VALUES, 1e-3) as fmu,
    ):
        advance(fmu, 60)


def test_an_fmu_that_no_user_names_is_not_run(write_fmu: WriteFmu) -> None:
    table = table_of(write_fmu)
    with (
        pytest.raises(InputError, match="native code"),
        open_fmu(table.model_copy(update={"model": "model.fmu"}), VALUES, 1e-3),
    ):
        pass


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"head_height_m": ("height9",)}, "no real variable 'height9'"),
        ({"head_height_m": ("force1",)}, "'force1' is input"),
        ({"contact_force_N": ("lift",)}, "'lift' is parameter"),
        ({"parameters": {"mass": 1.0}}, "no parameter 'mass'"),
        ({"base_height_m": "force2"}, "has the unit 'N'"),
        ({"interface": "model-exchange", "sha256": "0" * 64}, "has the SHA-256"),
    ],
)
def test_variables_that_do_not_fit_are_named(write_fmu: WriteFmu, change: dict[str, object], reason: str) -> None:
    table = table_of(write_fmu).model_copy(update=change)
    with pytest.raises(InputError, match=reason), open_fmu(table, VALUES, 1e-3):
        pass


def test_a_model_with_many_variables_is_described(write_fmu: WriteFmu) -> None:
    """The named variables are found behind 8,000 others, whose facts exceed an answer of 1 MB."""
    table = table_of(write_fmu, outputs=["x1"], version=3)
    path = Path(table.model)
    with zipfile.ZipFile(path) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    shared = 'causality="local" variability="continuous" initial="calculated" unit="N"'
    names = (f"body{n}.{'q' * 100}" for n in range(8000))
    others = "".join(f'<Float64 name="{name}" valueReference="{2000 + n}" {shared}/>' for n, name in enumerate(names))
    text = entries["modelDescription.xml"].decode()
    entries["modelDescription.xml"] = text.replace("<ModelVariables>", f"<ModelVariables>{others}").encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    with open_fmu(table.model_copy(update={"sha256": None}), VALUES, 1e-3) as fmu:
        assert np.isfinite(fmu.attempt(np.array([100.0]))).all()
        assert {"force1", "height1", "x1", "fault", "lift"} <= set(fmu.facts.variables)


BASE = dict.fromkeys(("kg", "m", "s", "A", "K", "mol", "cd", "rad", "offset"), 0.0) | {"factor": 1.0}


@pytest.mark.parametrize(
    ("unit", "base", "factor"),
    [("", None, 1.0), ("kN", None, 1e3), ("kN", BASE | {"kg": 1.0, "m": 1.0, "s": -2.0, "factor": 1e3}, 1e3)],
)
def test_units_of_forces(unit: str, base: dict[str, float] | None, factor: float) -> None:
    facts = FmuFacts("2.0", "m", "", "", True, {"f": {"causality": "input", "unit": unit, "base": base}})
    assert find_scale("contact_force_N", "N", "f", facts, "FMU").factor == factor


@pytest.mark.parametrize(("unit", "base"), [("lbf", None), ("Nm", BASE | {"kg": 1.0, "m": 2.0, "s": -2.0})])
def test_a_unit_of_another_quantity_is_refused(unit: str, base: dict[str, float] | None) -> None:
    facts = FmuFacts("2.0", "m", "", "", True, {"f": {"causality": "input", "unit": unit, "base": base}})
    with pytest.raises(InputError, match=f"has the unit '{unit}'"):
        find_scale("contact_force_N", "N", "f", facts, "FMU")


def test_energy_of_the_coupling_limits_the_verdict(write_fmu: WriteFmu) -> None:
    with open_fmu(table_of(write_fmu), VALUES, 1e-3) as fmu:
        coupling = Coupling(energy=-0.99, exchanged=100.0, largest_difference=2e-6, attempts=10)
        run = describe_coupling(1, fmu, coupling, 1)
        assert (run.energy_J, run.model, run.tool) == (-0.99, "linear pantograph 1.2", "test compiler")
        assert run.sha256 == fmu.table.sha256
        with pytest.raises(FmuFailed, match=r"made -1.01 J, more than 1%"):
            describe_coupling(1, fmu, replace(coupling, energy=-1.01), 1)
