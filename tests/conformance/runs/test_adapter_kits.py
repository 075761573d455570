"""Kits for adapters: records without uplift at supports, and the place of an error of a simulator."""

import shutil
import sys
from pathlib import Path

import pytest

from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.runs.system import Delivered, Outcome
from pantocheck.conformance.runs.system_choice import choose_system

EXAMPLES = Path(__file__).parents[3] / "examples"

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

OCTAVE = """
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
    (folder / "simulate.m").write_text(OCTAVE.replace("FAILS", str(fails).lower()))
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
