"""The two adapters under `examples/`, run as a user runs them."""

import sys
import sysconfig
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import library_folder, load_case
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.outcome import Delivered, Skipped
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator
from pantocheck.conformance.systems.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """The 250 km/h case on five spans in place of ten."""
    folder = tmp_path_factory.mktemp("short")
    for name, old, new in (
        ("250.toml", "evaluated_spans = [5, 6]", "evaluated_spans = [3, 4]"),
        ("line.toml", "spans = 10", "spans = 5"),
        ("pantograph.toml", "", ""),
    ):
        text = (library_folder() / "en50318-2002" / name).read_text(encoding="utf-8")
        assert old in text
        (folder / name).write_text(text.replace(old, new), encoding="utf-8")
    return load_case(folder / "250.toml")


@pytest.fixture(scope="module")
def reference(short):
    return evaluate_record(ReferenceSimulator().run_unrefined(short).record, short.file.filter.low_pass).values[1]


def adapter(name, *arguments):
    return choose_system(f"command:'{sys.executable}' '{EXAMPLES / name / 'adapter.py'}' {' '.join(arguments)}", 100.0)


def test_plain_simulator_agrees_with_the_reference_simulator(short: Case, reference: dict[str, Any]) -> None:
    """Two formulations of the same line. Second-order differences at 0.5 m are within a tenth up to 20 Hz."""
    outcome = adapter("string_catenary").run(short)
    assert isinstance(outcome, Delivered)
    values = evaluate_record(outcome.record, short.file.filter.low_pass).values[1]
    assert_allclose(values["mean_force_N"], reference["mean_force_N"], rtol=0.02)
    assert_allclose(values["std_force_N"], reference["std_force_N"], rtol=0.1)
    assert outcome.run.element_m == 0.5


def test_plain_simulator_skips_unsupported_cases(short: Case) -> None:
    twin = short.line.contact_wire.model_copy(update={"number": 2, "spacing_m": 0.04})
    line = short.line.model_copy(update={"contact_wire": twin})
    system = adapter("string_catenary")
    case = type(short)(short.file, line, short.pantographs, short.limits)
    outcome = system.run(case)
    assert isinstance(outcome, Skipped)
    assert "twin contact wires" in outcome.reason
    assert (system.name, system.version) == ("string catenary", "1.0")


def test_external_program_agrees_with_the_same_program_in_process(short: Case, reference: dict[str, Any]) -> None:
    """The same program behind files and pipes: HDF5 keeps every digit, so the quantities are the same."""
    command = Path(sysconfig.get_path("scripts"), "pantocheck")
    outcome = adapter("external_program", f"'{command}'").run(short)
    assert isinstance(outcome, Delivered)
    values = evaluate_record(outcome.record, short.file.filter.low_pass).values[1]
    assert_allclose([values[name] for name in reference], list(reference.values()), rtol=1e-9)
