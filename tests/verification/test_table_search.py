"""Search for the scenario of Table 1: the case is the scenario that the stored search chooses."""

import csv
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import ValuesByOwner
from pantocheck.conformance.studies.vovan2015.damping_change import compare_force
from verification.tables.table_scenarios import (
    CHOSEN,
    InitialRun,
    Scenario,
    build_case,
    load_study,
    run_initial,
    wave_speed,
)
from verification.tables.table_search import (
    LARGEST_CONTACT_LOSS_PCT,
    LARGEST_UPLIFT_MM,
    count_reproduced,
    front_grid,
    level_error,
)

DOCS = Path(__file__).parents[2] / "docs"


def printed_values(model: str) -> ValuesByOwner:
    study = load_study().file.study
    return {table.pantograph: dict(table.values) for table in study.printed if table.model == model}


def test_case_is_the_chosen_scenario() -> None:
    case, scenario = load_study(), build_case(CHOSEN)
    assert case.file.speed_km_h == CHOSEN.speed_km_h
    assert case.file.spacing_m == (CHOSEN.spacing_m,)
    assert case.pantographs == scenario.pantographs
    assert case.line.contact_wire == scenario.line.contact_wire
    assert case.line.messenger_wire == scenario.line.messenger_wire
    assert case.line.geometry.span_m == scenario.line.geometry.span_m
    # The file gives positions to a millimetre and the pre-sag to a hundredth of a millimetre.
    assert_allclose(case.line.droppers.x_m, scenario.line.droppers.x_m, atol=6e-4)
    assert_allclose(case.line.droppers.presag_m, scenario.line.droppers.presag_m, atol=6e-6)


def stored_search() -> list[dict[str, str]]:
    with (DOCS / "table-1-search.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_chosen_scenario_is_the_closest_plausible_one_of_the_stored_search() -> None:
    rows = stored_search()
    assert len(rows) == len(list(front_grid()))
    plausible = [
        row
        for row in rows
        if float(row["contact_loss_pct"]) <= LARGEST_CONTACT_LOSS_PCT and float(row["uplift_mm"]) <= LARGEST_UPLIFT_MM
    ]
    closest = min(plausible, key=lambda row: float(row["level_error"]))
    assert [closest[name] for name in CHOSEN._fields[:-1]] == [str(value) for value in CHOSEN[:-1]]


def test_stored_levels_are_those_of_the_simulator() -> None:
    """The file has three digits; another order of floating-point operations changes less than 1 %."""
    front = CHOSEN._replace(spacing_m=None)
    (row,) = (row for row in stored_search() if Scenario._make(row[name] for name in Scenario._fields) == _text(front))
    run = run_initial(front)
    assert run is not None
    for name in BAND_QUANTITIES:
        assert run.values[1][name] == pytest.approx(float(row[f"{name} 1"]), rel=0.01)


def _text(scenario: Scenario) -> tuple[str, ...]:
    return tuple("" if value is None else str(value) for value in scenario)


def test_printed_levels_and_changes_reproduce_every_finding() -> None:
    initial = printed_values("initial")
    assert level_error(InitialRun(CHOSEN, initial, ())) == 0
    doubled = {p: {name: 2 * value for name, value in table.items()} for p, table in initial.items()}
    assert level_error(InitialRun(CHOSEN, doubled, ())) == pytest.approx(0.6931, abs=1e-4)  # ln 2
    changes = compare_force(printed_values("initial"), printed_values("updated"))
    assert count_reproduced(changes) == len(load_study().limits) == 12


def test_grid_obeys_the_rule_on_the_wave_speed() -> None:
    """At 300 km/h a contact wire of 20 kN has 0.68 of the wave speed."""
    scenarios = list(front_grid())
    assert {scenario.speed_km_h for scenario in scenarios} == {270.0, 285.0, 300.0}
    assert max(scenario.speed_km_h / 3.6 / wave_speed(scenario) for scenario in scenarios) == pytest.approx(
        0.68, abs=0.005
    )
