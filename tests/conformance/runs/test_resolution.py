"""Resolution of the reported bands: the criterion on element and time step, against measured errors."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from helpers.short_cases import change_case
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.resolution import (
    Effect,
    list_model_uncertainty,
    longest_element,
    longest_time_step,
    period_error,
    read_effects,
    resolution_warnings,
    smallest_reach,
)

STD, EXTENDED = "std_force_N", "rms_20_50_N"
FINE = (0.25, 0.5e-3)


@pytest.fixture(scope="module")
def case_300() -> Case:
    return load_case(library_folder() / "en50318-2002" / "300.toml")


def errors(case: Case, element: float, time_step: float) -> dict[str, float]:
    """Relative errors of the standard deviation and of the RMS in 20-50 Hz, against a fine mesh."""
    coarse, fine = (values(change_case(case, mesh=steps)) for steps in ((element, time_step), FINE))
    return {name: abs(coarse[name] / fine[name] - 1) for name in (STD, EXTENDED) if name in coarse}


def values(case: Case) -> dict[str, float]:
    record = ReferenceSimulator().run_unrefined(case).record
    return {name: float(value) for name, value in evaluate_record(record, case.file.filter).values[1].items()}


def warned(case: Case, element: float, time_step: float) -> list[str]:
    """Subject and frequency of each warning, such as `time step 50`."""
    texts = resolution_warnings(case, change_case(case, mesh=(element, time_step)).file.discretisation)
    return [f"{text.split(':')[0]} {edge}" for text in texts for edge in (20, 50) if f"to {edge} Hz" in text]


@pytest.mark.parametrize(("element", "time_step"), [(0.5, 1e-3), (1.1, 1e-3)])
def test_errors_without_a_warning_are_small(case_300: Case, element: float, time_step: float) -> None:
    """At most 2 % of sigma and 5 % of the RMS in 20-50 Hz."""
    assert warned(case_300, element, time_step) == []
    found = errors(case_300, element, time_step)
    assert found[STD] < 0.02
    assert found[EXTENDED] < 0.05


@pytest.mark.parametrize(
    ("element", "time_step", "expected"),
    [
        (3.0, 1e-3, ["element length 20", "element length 50"]),
        (0.5, 5e-3, ["time step 20", "time step 50"]),
        (0.5, 1e-2, ["time step 20"]),
    ],
)
def test_errors_with_a_warning_are_large(case_300: Case, element: float, time_step: float, expected: list[str]) -> None:
    """More than 5 % of sigma. At 10 ms the record has no 20-50 Hz band, which is therefore not named."""
    assert warned(case_300, element, time_step) == expected
    assert errors(case_300, element, time_step)[STD] > 0.05


def test_simulator_delivers_the_warnings_and_no_library_case_has_one(case_300: Case) -> None:
    case = change_case(case_300, mesh=(3.0, 5e-3))
    assert ReferenceSimulator().run_unrefined(case).warnings == resolution_warnings(case, case.file.discretisation)
    cases = [case for case in select_cases(["*"]) if not case.is_static]
    assert len(cases) >= 8
    assert [case.id for case in cases if resolution_warnings(case, case.file.discretisation)] == []


def test_period_error_is_that_of_average_acceleration() -> None:
    """Exact: w dt / 2 = tan(w' dt / 2) with the frequency w' of the scheme; for small steps the square remains."""
    omega, dt = 2 * math.pi * 20.0, 1e-3
    computed = 2 / dt * math.atan(omega * dt / 2)
    assert omega / computed - 1 == pytest.approx(period_error(20.0, dt), rel=2e-3)
    assert period_error(50.0, longest_time_step(50.0)) == pytest.approx(0.01, rel=1e-12)


def test_message_names_the_remedy(case_300: Case) -> None:
    """250/3 m/s over 50 and 70 elements per second; 18.1 steps per period of 20 ms."""
    texts = resolution_warnings(case_300, change_case(case_300, mesh=(1.5, 2e-3)).file.discretisation)
    assert texts == (
        "time step: 2 ms changes the period at 50 Hz by 3.3 %: quantities up to 50 Hz are not accurate. "
        "Set time_step_s to at most 0.0011",
        "element length: a pantograph passes 55.6 elements of 1.5 m per second; quantities up to 50 Hz need 70. "
        "Set element_m to at most 1.1",
    )
    assert resolution_warnings(case_300, change_case(case_300, mesh=(1.1, 0.0011)).file.discretisation) == ()
    assert longest_element(case_300.speed, 20.0) == pytest.approx(case_300.speed / 50)


# Warning of an active window from whose edges waves return: it comes where the contact force changes.
SMALLEST_M = 180
"""Half-width for 300 km/h over 360 m (4.32 s), with waves of 1.1 times 122 m/s on the messenger wire [m]."""


def limit_window(reach: float | None) -> Case:
    """Case of EN 50318:2002 at 300 km/h with a limited window, on a coarse mesh."""
    case = load_case(library_folder() / "en50318-2002" / "300.toml")
    changes = {"element_m": 1.5, "time_step_s": 0.002, "reach_m": reach}
    discretisation = case.file.discretisation.model_copy(update=changes)
    return replace(case, file=case.file.model_copy(update={"discretisation": discretisation}))


def run(reach: float | None) -> tuple[np.ndarray, list[str]]:
    """Contact force [N] and warnings on the window."""
    delivered = ReferenceSimulator().run_unrefined(limit_window(reach))
    return delivered.record.force[0], [text for text in delivered.warnings if text.startswith("active window")]


@pytest.mark.parametrize(("speed", "expected"), [(0.0, 500.0), (60.0, 320.0), (100.0, math.inf), (120.0, math.inf)])
def test_half_width_by_hand(speed: float, expected: float) -> None:
    """A wave of 100 m/s in 10 s: 500 m to and fro at rest; at 60 m/s 320 m, 8 s ahead and 2 s back."""
    assert smallest_reach(100.0, speed, 10.0) == pytest.approx(expected, rel=1e-12)
    if speed == 60.0:
        assert expected / (100 - speed) + expected / (100 + speed) == pytest.approx(10.0, rel=1e-12)


def test_narrow_window_changes_the_force_and_is_named_unless_it_holds_the_line() -> None:
    """Without a limit, and with the suitable one, the forces agree to rounding (1e-6 N) and nothing is said."""
    free, silence = run(None)
    narrow, (warning,) = run(60.0)
    assert np.abs(narrow - free).max() > 1.0
    assert "60 m from the train" in warning
    assert warning.endswith(f"Leave out reach_m, or set it to at least {SMALLEST_M}")
    suitable, none = run(float(SMALLEST_M))
    assert np.abs(suitable - free).max() < 1e-6
    assert (silence, none) == ([], [])
    # The line is 600 m long.
    assert run(600.0)[1] == []


# Model uncertainty of the reference simulator: the library holds the table of the page, a case names its effects.
PAGE = Path(__file__).parents[3] / "docs" / "exact-model.md"


def cells(effect: Effect) -> dict[str, str]:
    """Sizes as the page prints them, by quantity."""
    units = {"min_force_N": "N"}
    relative = {name: f"{size:.1f} %" for name, size in effect.relative_pct.items()}
    return relative | {name: f"{size:.1f} {units[name]}" for name, size in effect.absolute.items()}


def test_page_has_the_sizes_of_the_library() -> None:
    section = PAGE.read_text(encoding="utf-8").split("## Model uncertainty")[1].split("\n## ")[0]
    rows = [re.split(r" *\| *", line.strip("| ")) for line in section.splitlines() if line.startswith("|")]
    table = {row[0]: dict(zip(rows[0][1:], row[1:], strict=True)) for row in rows[2:]}
    assert {effect.along_track or "any, another contact": cells(effect) for effect in read_effects()} == table


@pytest.mark.parametrize(
    ("along_track", "start"), [("free", "Messenger wire of constant tension"), ("fixed", "Messenger wire whose")]
)
def test_case_names_the_effects_of_its_supports(along_track: str, start: str) -> None:
    case = select_cases(["en50318-2002/250"])[0]
    support = case.line.messenger_support.model_copy(update={"along_track": along_track})
    changed = case.line.model_copy(update={"messenger_support": support})
    sentence, _ = list_model_uncertainty(replace(case, line=changed))
    assert sentence.startswith(start)
    assert sentence.endswith("docs/exact-model.md.")
