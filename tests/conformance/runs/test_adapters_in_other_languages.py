"""Adapters in C++ and Octave: the kits, and the string catenary that both compute as the Python example does."""

import hashlib
import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from helpers.listed_spans import vary_short_line
from helpers.short_cases import change_case
from pantocheck.conformance.app.self_test.adapter_check import build_short_case, check_adapter
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.system import Delivered, Outcome, System
from pantocheck.conformance.runs.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"
LANGUAGES = ("cpp", "octave")
OCTAVE = f"command:octave-cli --quiet '{EXAMPLES / 'octave_catenary' / 'adapter.m'}'"


@pytest.fixture(params=LANGUAGES)
def adapter(request: pytest.FixtureRequest) -> System:
    if request.param == "cpp":
        return choose_system(f"command:'{request.getfixturevalue('compiled')}'", 100.0)
    if shutil.which("octave-cli") is None:
        pytest.skip("octave-cli is not installed")
    return choose_system(OCTAVE, 100.0)


@pytest.fixture(scope="module")
def coarse() -> Case:
    """The short case with elements of 2 m and a time step of 4 ms, which each program computes in seconds."""
    return change_case(build_short_case(), mesh=(2.0, 0.004))


@pytest.fixture(scope="module")
def varied(coarse: Case) -> Case:
    """The same case on listed spans of different length, with supports of different height and stiffness."""
    return vary_short_line(coarse)


def evaluate(system: System, case: Case) -> dict[str, Value]:
    """Quantities of the pantograph, and the largest uplift of all supports."""
    outcome = system.run(case)
    assert isinstance(outcome, Delivered), outcome
    values = evaluate_record(outcome.record, case.file.filter).values[1]
    return values | {"uplift": float(outcome.record.support_uplift.max())}


@pytest.fixture(scope="module")
def python_values(varied: Case) -> dict[str, Value]:
    program = EXAMPLES / "string_catenary" / "adapter.py"
    return evaluate(choose_system(f"command:'{sys.executable}' '{program}'", 100.0), varied)


@pytest.fixture(scope="module")
def cpp_values(compiled: Path, varied: Case) -> dict[str, Value]:
    return evaluate(choose_system(f"command:'{compiled}'", 100.0), varied)


@pytest.fixture(scope="module")
def octave_values(varied: Case) -> dict[str, Value]:
    if shutil.which("octave-cli") is None:
        pytest.skip("octave-cli is not installed")
    return evaluate(choose_system(OCTAVE, 100.0), varied)


@pytest.mark.parametrize("language", LANGUAGES)
def test_same_equations_give_the_same_values(
    language: str, varied: Case, python_values: dict[str, Value], request: pytest.FixtureRequest
) -> None:
    """The programs differ from the Python example in the wire at rest: a string, or finite differences with bending."""
    # With elements of 2 m, this moves the height by 0.4 mm, the mean force by 0.15 % and the other values by 1.2 %.
    values = request.getfixturevalue(f"{language}_values")
    assert_allclose(values["mean_force_N"], python_values["mean_force_N"], rtol=3e-3)
    for quantity in ("std_force_N", "contact_height_range_mm", "uplift"):
        assert_allclose(values[quantity], python_values[quantity], rtol=0.02, err_msg=quantity)


def test_cpp_and_octave_agree(cpp_values: dict[str, Value], octave_values: dict[str, Value]) -> None:
    """The same formulas in two languages: only rounding differs, of numbers written with nine digits."""
    for quantity in ("mean_force_N", "std_force_N", "max_force_N", "rms_20_50_N", "uplift"):
        assert_allclose(cpp_values[quantity], octave_values[quantity], rtol=1e-6, err_msg=quantity)


def test_adapter_in_cpp_is_complete_and_ends_on_broken_messages(compiled: Path) -> None:
    """The record of the short case is complete and verified."""
    assert check_adapter(choose_system(f"command:'{compiled}'", 100.0)).passed
    # A message that is not JSON is a fault of the suite; the program must not hang.
    done = subprocess.run([compiled], input=b"{broken\n", capture_output=True, check=False, timeout=10)
    assert done.returncode != 0


def test_unsupported_cases_are_skipped(adapter: System, coarse: Case) -> None:
    twin = coarse.line.contact_wire.model_copy(update={"number": 2, "spacing_m": 0.04})
    outcome = adapter.run(replace(coarse, line=coarse.line.model_copy(update={"contact_wire": twin})))
    assert outcome.reason == "the system does not simulate twin_wires"


TEXTS = ["", "a" * 55, "b" * 56, "c" * 63, "d" * 64, "e" * 1000, 'quoted "\\" \t\n\x01\x7f', "é Ω 東 🚄 \u2028"]


def test_texts_and_digests_of_the_kit_in_cpp(tmp_path: Path) -> None:
    """JSON texts with every kind of escape are read, SHA-256 is that of hashlib, and quoted texts are JSON again."""
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    (tmp_path / "test.cpp").write_text(
        f'#include "{EXAMPLES / "cpp_catenary" / "pantocheck_adapter.hpp"}"\n'
        "int main() { for (std::string line; std::getline(std::cin, line);) {"
        " const std::string text = pantocheck::JsonParser(line).parse().characters;"
        ' std::cout << pantocheck::sha256(text) << " " << pantocheck::quote(text) << std::endl; } }'
    )
    subprocess.run(["g++", "-std=c++17", "-o", "test", "test.cpp"], cwd=tmp_path, check=True)
    for escaped in (True, False):
        lines = "".join(json.dumps(text, ensure_ascii=escaped) + "\n" for text in TEXTS)
        done = subprocess.run([tmp_path / "test"], input=lines.encode(), capture_output=True, check=True)
        for text, answer in zip(TEXTS, done.stdout.decode().split("\n"), strict=False):
            digest, _, quoted = answer.partition(" ")
            assert digest == hashlib.sha256(text.encode()).hexdigest()
            assert json.loads(quoted) == text


# Kits for adapters: records without uplift at supports, and the place of an error of a simulator.


PYTHON = """
from pantocheck_adapter import START_OF_THE_CASE, Record, serve

def divide(number):
    return 1 / number

def simulate(case):
    if FAILS:
        divide(0)
    time = [0.002 * n for n in range(1, 2000)]
    position = [case["pantographs"][0]["start_m"] + case["speed_km_h"] / 3.6 * t for t in time]
    force = [[120.0 for _ in time]]
    return Record(time_s=time, position_m=[position], force_N=force, start=START_OF_THE_CASE)

serve("kit", "1", simulate, FEATURES)
"""

OCTAVE_KIT = """
function record = simulate(given)
  if FAILS
    error('no equilibrium');
  end
  time = 0.002 * (1:1999)';
  position = given.pantographs(1).start_m + given.speed_km_h / 3.6 * time;
  start = struct('place_m', given.pantographs(1).start_m, 'ramp_m', 0, 'state', 'equilibrium_under_uplift_forces');
  record = struct('time_s', time, 'position_m', position, 'force_N', 120 + 0 * time, 'contact_height_m', [], ...
    'support_position_m', [], 'uplift_m', [], 'start', start, 'dt_s', 0.002, 'element_m', 0.5, 'note', 'none');
end
"""


FEATURES = ["bending_stiffness", "chain", "droppers", "presag", "rayleigh_damping", "steady_arms"]


def run_kit(folder: Path, language: str, fails: bool) -> Outcome:
    case: Case = build_short_case()
    if language == "python":
        shutil.copy(EXAMPLES / "string_catenary" / "pantocheck_adapter.py", folder)
        (folder / "adapter.py").write_text(PYTHON.replace("FAILS", str(fails)).replace("FEATURES", repr(FEATURES)))
        return choose_system(f"command:'{sys.executable}' '{folder / 'adapter.py'}'", 60.0).run(case)
    if shutil.which("octave-cli") is None:
        pytest.skip("octave-cli is not installed")
    shutil.copy(EXAMPLES / "octave_catenary" / "pantocheck_serve.m", folder)
    (folder / "simulate.m").write_text(OCTAVE_KIT.replace("FAILS", str(fails).lower()))
    (folder / "adapter.m").write_text(
        f"addpath('{folder}'); pantocheck_serve('kit', '1', @simulate, {{{str(FEATURES)[1:-1]}}});"
    )
    return choose_system(f"command:octave-cli --quiet '{folder / 'adapter.m'}'", 60.0).run(case)


@pytest.mark.parametrize("language", ["python", "octave"])
def test_a_record_without_uplift_is_read(tmp_path: Path, language: str) -> None:
    outcome = run_kit(tmp_path, language, fails=False)
    assert isinstance(outcome, Delivered), outcome
    assert outcome.record.support_position is None


@pytest.mark.parametrize(
    ("language", "reason"),
    [
        ("python", "ZeroDivisionError: division by zero (adapter.py, line 9; adapter.py, line 5)"),
        ("octave", "no equilibrium (simulate, line 4)"),
    ],
)
def test_an_error_of_the_simulator_has_its_place(tmp_path: Path, language: str, reason: str) -> None:
    outcome = run_kit(tmp_path, language, fails=True)
    assert reason in outcome.reason
