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
from pantocheck.conformance.app.self_test.adapter_check import build_short_case, check_adapter
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.system import Delivered, System
from pantocheck.conformance.runs.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"
LANGUAGES = ("cpp", "octave")
OCTAVE = f"command:octave-cli --quiet '{EXAMPLES / 'octave_catenary' / 'adapter.m'}'"


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The adapter in C++, compiled without a warning."""
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    program = tmp_path_factory.mktemp("cpp") / "adapter"
    source = EXAMPLES / "cpp_catenary" / "adapter.cpp"
    options = ["-O2", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["g++", *options, "-o", str(program), str(source)], check=True)
    return program


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
    case = build_short_case()
    discretisation = case.file.discretisation.model_copy(update={"element_m": 2.0, "time_step_s": 0.004})
    return replace(case, file=case.file.model_copy(update={"discretisation": discretisation}))


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


def test_nothing_is_missing_in_the_adapter_in_cpp(compiled: Path) -> None:
    """The record of the short case is complete and verified."""
    assert check_adapter(choose_system(f"command:'{compiled}'", 100.0)).passed


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


def test_broken_messages_end_the_program_in_cpp(compiled: Path) -> None:
    """A message that is not JSON is a fault of the suite; the program must not hang."""
    done = subprocess.run([compiled], input=b"{broken\n", capture_output=True, check=False, timeout=10)
    assert done.returncode != 0
