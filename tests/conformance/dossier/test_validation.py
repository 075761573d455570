"""The example dossier passes; with a step removed, spoiled or beyond its limits, that step does not pass.

The claims rest on every step: none of them passes then, and all other steps do.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.example_dossier import CachedSimulator, Spoil, copy_example, edit_column, list_verdicts, validate_example
from helpers.toml_edit import edit_toml, write_toml
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.dossier import validation
from pantocheck.conformance.dossier.line_test_step import LineTests
from pantocheck.conformance.dossier.step_result import StepResult
from pantocheck.conformance.results.procedure_format import STEP_NAMES

ALL_PASS = dict.fromkeys(STEP_NAMES, "pass")
NOT_VERIFIED = {"limits_of_validity": "skip"}
"""Claims of the example without the pair that verifies them."""

ORDER = ["error", "fail", "skip", "info", "unconfirmed", "pass"]


def drop_column(name: str, column: str) -> Spoil:
    """Remove a column of a measured table."""

    def spoil(folder: Path) -> None:
        path = folder / "measured" / name
        cells = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]
        place = cells[0].index(column)
        lines = (",".join(row[:place] + row[place + 1 :]) for row in cells)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    return spoil


def drop_rows(name: str, first: int, last: int) -> Spoil:
    """Remove rows of a measured table, numbered from 1 below the head line."""

    def spoil(folder: Path) -> None:
        path = folder / "measured" / name
        lines = path.read_text(encoding="utf-8").splitlines()
        path.write_text("\n".join(lines[:first] + lines[last + 1 :]) + "\n", encoding="utf-8")

    return spoil


def edit_sidecar(name: str, changes: dict[str, Any]) -> Spoil:
    """Change keys of the sidecar of a measured table."""
    return lambda folder: edit_toml(folder / "measured" / name, changes)


def replace_record(name: str, other: str) -> Spoil:
    """Replace the table of a record by other bytes."""
    return lambda folder: (folder / "measured" / name).write_text(other, encoding="utf-8")


@pytest.mark.parametrize("changes", ["one pair", "all pairs"])
def test_complete_dossier_passes(system: CachedSimulator, tmp_path: Path, changes: str) -> None:
    """All six steps pass, with verified runs, and every verdict follows from the numbers of results.json."""
    path = copy_example(tmp_path / "in", ONE_PAIR if changes == "one pair" else {})
    results = validate_example(path, system, tmp_path / "out")
    assert list_verdicts(results) == ALL_PASS
    assert results.verdict == "pass"
    assert find_discrepancies(results) == []
    assert [step.step for step in results.procedure.steps] == list(STEP_NAMES)
    assert all(case.record is not None and case.record.state == "consistent" for case in results.cases)
    for step in results.procedure.steps[:-1]:
        assert step.margin >= 0


def add_failing_case(folder: Path) -> None:
    """Write a case whose limit its run exceeds."""
    limit = {"quantity": "mean_force_N", "pantograph": 1, "upper": 50.0, "trust": "secondary", "source": "test"}
    content = (folder / "run-160.toml").read_text(encoding="utf-8")
    (folder / "failing.toml").write_text(content, encoding="utf-8")
    edit_toml(folder / "failing.toml", {"id": "own/failing", "limit": [limit]})


ONE_PAIR: dict[str, Any] = {
    "line.0.element_m": 1.0,
    "pair.2": None,
    "pair.1": None,
    "validity.speed_km_h": [160.0, 160.0],
    "validity.spacing_m": None,
}
"""The example with one pair, and claims that it verifies: half a second in place of one."""

OTHER_PANTOGRAPH = {"name": "other", "file": "en50318-2002/pantograph.toml"}


def add_passing_case(folder: Path) -> None:
    """Write an own case whose limit its run meets."""
    add_failing_case(folder)
    (folder / "failing.toml").rename(folder / "own.toml")
    edit_toml(folder / "own.toml", {"limit.0.upper": 500.0})


def add_limits(folder: Path) -> None:
    """Write a file of limits that the reference model exceeds."""
    limit = {"case": "*/250", "quantity": "std_force_N", "pantograph": 1, "upper": 20.0, "trust": "secondary"}
    write_toml(folder / "limits.toml", {"limit": [limit | {"source": "test"}]})


@dataclass(frozen=True)
class Variant:
    """Changed keys of the dossier, changed files, and the steps that then do not pass."""

    changes: dict[str, Any]
    expected: dict[str, str]
    spoil: Spoil


def change(changes: dict[str, Any], expected: str, spoil: Spoil = lambda folder: None) -> Variant:
    """Variant by changed keys; the text names steps and their verdicts. Without the line test, no claim is verified."""
    words = expected.split()
    steps = dict(zip(words[::2], words[1::2], strict=True))
    return Variant(changes, steps | (NOT_VERIFIED if "line_test" in steps else {}), spoil)


def spoiled(expected: str, spoil: Spoil) -> Variant:
    return change({}, expected, spoil)


VARIANTS = {
    "no response": change({"pantograph.0.responses": None}, "pantograph_model skip"),
    "no response of a load": change({"pantograph.0.responses": ["measured/response-70N.csv"]}, "pantograph_model skip"),
    "no limit of a band": change({"pantograph.0.limit.1": None}, "pantograph_model skip"),
    "tight limit of the response": change({"pantograph.0.limit.1.upper": 0.5}, "pantograph_model fail"),
    "response limits that test nothing": change({"pantograph.0.limit.1.upper": 60.0}, "pantograph_model info"),
    "response of a heavier head": spoiled(
        "pantograph_model fail", edit_column("response-70N.csv", "modulus_kg", lambda m: 1.1 * m)
    ),
    "response in another unit": spoiled(
        "pantograph_model error", edit_column("response-70N.csv", "modulus_kg", lambda m: 1e3 * m)
    ),
    "response with lost rows": spoiled("pantograph_model error", drop_rows("response-110N.csv", 60, 70)),
    "no static values": change({"line.0.statics": None}, "static_check skip"),
    "no tolerance of the height": change({"line.0.tolerance.height_mm": None}, "static_check skip"),
    "tight tolerance of the elasticity": change({"line.0.tolerance.elasticity_pct": 1.0}, "static_check fail"),
    "static tolerances that test nothing": change({"line.0.tolerance.elasticity_pct": 60.0}, "static_check info"),
    "wire at another height": spoiled(
        "static_check fail", edit_column("statics.csv", "contact_wire_height_m", lambda z: z + 0.02)
    ),
    "no measured height": spoiled("static_check skip", drop_column("statics.csv", "contact_wire_height_m")),
    "static values with lost rows": spoiled("static_check skip", drop_rows("statics.csv", 30, 33)),
    "elasticity in another unit": spoiled(
        "static_check error", edit_column("statics.csv", "elasticity_mm_N", lambda e: 1e3 * e)
    ),
    "no parameters": change({"parameters": None}, "simulation_parameters skip"),
    "smaller time step declared": change({"parameters.time_step_s": 5e-4}, "simulation_parameters fail"),
    "no start declared": change({"parameters.start": None}, "simulation_parameters skip"),
    "mesh declared in words": change({"parameters.element_m": "fine"}, "simulation_parameters unconfirmed"),
    "no reference model": change({"reference": None}, "reference_models skip"),
    "reference model without limits": change({"reference.cases": ["run-160.toml"]}, "reference_models info"),
    "own case with limits as reference model": change(
        {"reference.cases": ["own.toml"]}, "reference_models info", add_passing_case
    ),
    "line at rest as reference model": change(
        {"reference.cases": ["en50318-2018/ac-simple/static"]}, "reference_models info"
    ),
    "own limits of a reference model": change({"reference.limits": "limits.toml"}, "reference_models fail", add_limits),
    "reference model beyond its limit": change(
        {"reference.cases": ["failing.toml"]}, "reference_models fail", add_failing_case
    ),
    "no pair": change({"pair": None}, "line_test skip"),
    "no tolerance of sigma": change({"line_test.tolerance.1": None}, "line_test skip"),
    "tight tolerance of sigma": change({"line_test.tolerance.1.tolerance_pct": 1.0}, "line_test fail"),
    "provisional tolerances": change({"line_test": None}, "line_test info"),
    "other direction": change({"pair.0.measured.direction": "down"}, "line_test skip"),
    "other speed": change({"pair.0.measured.record": "measured/run-200.csv"}, "line_test skip"),
    "other section": spoiled("line_test skip", edit_sidecar("run-160.toml", {"evaluated_m": [250.0, 500.0]})),
    "measured by the system": spoiled(
        "line_test error", edit_sidecar("run-160.toml", {"system.name": CachedSimulator.name})
    ),
    "measured force too large": spoiled(
        "line_test fail", edit_column("run-160.csv", "force_1_N", lambda f: 1.4 * f - 34)
    ),
    "support without measured uplift": spoiled("line_test skip", drop_column("run-160.csv", "uplift_3_mm")),
    "no measured contact height": spoiled("line_test skip", drop_column("run-160.csv", "contact_height_1_mm")),
    "gap in the measured force": spoiled("line_test skip", drop_rows("run-160.csv", 500, 600)),
    "no measured analysis section": spoiled("line_test skip", edit_sidecar("run-160.toml", {"evaluated_m": None})),
    "unreadable record": spoiled("line_test error", replace_record("run-160.csv", "no table")),
    "no claim": change({"validity": None}, "limits_of_validity skip"),
    "claim on another pantograph": change(
        {"pantograph.1": OTHER_PANTOGRAPH, "validity.pantographs": ["other"]},
        "pantograph_model skip limits_of_validity skip",
    ),
    "claim on a higher speed": change({"validity.speed_km_h": [160.0, 165.0]}, "limits_of_validity skip"),
    "claim on another tension": change(
        {"validity.change": [{"key": "line.contact_wire.tension_N", "range": [18e3, 20e3]}]}, "limits_of_validity skip"
    ),
}


FULL_VARIANTS = {
    "other pantographs": change({"pair.2.simulated.case": "run-200.toml"}, "line_test skip"),
    "other spacing": spoiled("line_test skip", edit_sidecar("run-200-two.toml", {"spacing_m": [85.0]})),
    "same pair twice": change(
        {
            "pair.2.simulated.case": "run-200.toml",
            "pair.2.measured.record": "measured/run-200.csv",
            "pair.2.measured.pantographs": ["example pantograph"],
        },
        "line_test error",
    ),
    "claim beyond the tested speeds": change({"validity.speed_km_h": [160.0, 220.0]}, "limits_of_validity skip"),
    "claim beyond the tested spacing": change({"validity.spacing_m": [85.0, 200.0]}, "limits_of_validity skip"),
}
"""Variants that need all pairs."""


def rest_claims_on(steps: dict[str, str]) -> dict[str, str]:
    """Verdict of claims that rest on these steps: the worst of them, but not worse than `skip`, not verified."""
    worst = min(steps.values(), key=ORDER.index)
    return {"limits_of_validity": max(worst, "skip", key=ORDER.index)}


UNCHANGED_RUNS: dict[str, StepResult] = {}
"""Results of the reference models and of the line test of the complete dossier with one pair."""


@pytest.fixture
def _keep_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a variant of the other steps take both steps from the first one, whose files are the same."""

    def keep(name: str, step: Callable[..., StepResult]) -> Callable[..., StepResult]:
        def carry_out(*arguments: Any) -> StepResult:
            if name not in UNCHANGED_RUNS:
                UNCHANGED_RUNS[name] = step(*arguments)
            return UNCHANGED_RUNS[name]

        return carry_out

    monkeypatch.setattr(validation, "run_reference_models", keep("reference", validation.run_reference_models))
    monkeypatch.setattr(LineTests, "run", keep("line test", LineTests.run))


SAME_RUNS = {n: v for n, v in VARIANTS.items() if not {"reference_models", "line_test"} & v.expected.keys()}
"""Variants of the other steps."""


def check_variant(variant: Variant, keys: dict[str, Any], system: CachedSimulator, folder: Path) -> None:
    """No PASS overall; all verdicts follow from the numbers of results.json."""
    path = copy_example(folder / "in", keys | variant.changes)
    variant.spoil(path.parent)
    results = validate_example(path, system, folder / "out")
    assert list_verdicts(results) == ALL_PASS | rest_claims_on(variant.expected) | variant.expected
    worst = min(variant.expected.values(), key=ORDER.index)
    assert results.verdict == worst
    assert find_discrepancies(results) == []


@pytest.mark.usefixtures("_keep_runs")
@pytest.mark.parametrize("name", SAME_RUNS)
def test_variant_with_the_same_runs_has_the_verdict_of_its_step(
    system: CachedSimulator, tmp_path: Path, name: str
) -> None:
    check_variant(SAME_RUNS[name], ONE_PAIR, system, tmp_path)


@pytest.mark.parametrize("name", [name for name in VARIANTS if name not in SAME_RUNS])
def test_variant_of_the_runs_has_the_verdict_of_its_step(system: CachedSimulator, tmp_path: Path, name: str) -> None:
    check_variant(VARIANTS[name], ONE_PAIR, system, tmp_path)


@pytest.mark.parametrize("name", FULL_VARIANTS)
def test_variant_of_all_pairs_has_the_verdict_of_its_step(system: CachedSimulator, tmp_path: Path, name: str) -> None:
    check_variant(FULL_VARIANTS[name], {}, system, tmp_path)


def split_masts(offset: float) -> Spoil:
    """Put the uplift of a measured run into a file of 200 Hz, whose clock counts 41.7 s more, joined by an offset."""

    def spoil(folder: Path) -> None:
        path = folder / "measured" / "run-160.csv"
        names, table = (
            path.read_text(encoding="utf-8").splitlines()[0].split(","),
            np.loadtxt(path, delimiter=",", skiprows=1),
        )
        masts = [name.startswith("uplift") for name in names]
        time = np.arange(-4, 14, 0.005)
        rows = [np.interp(time, table[:, 0], row, left=0, right=0) for row in table[:, masts].T]
        for name, own, columns in (
            ("run-160.csv", [name for name in names if not name.startswith("uplift")], table[:, ~np.array(masts)]),
            (
                "masts.csv",
                ["time_s", *(n for n in names if n.startswith("uplift"))],
                np.column_stack([time + 41.7, *rows]),
            ),
        ):
            np.savetxt(folder / "measured" / name, columns, "%.9g", ",", header=",".join(own), comments="")
        join = {"kind": "time", "offset_s": offset, "uncertainty_s": 0.01}
        edit_toml(folder / "measured" / "run-160.toml", {"source": [{"file": "masts.csv", "join": join}]})

    return spoil


@pytest.mark.parametrize(("offset", "verdict"), [(-41.7, "pass"), (-40.7, "skip")])
def test_line_test_with_masts_in_a_file_of_their_own(
    system: CachedSimulator, tmp_path: Path, offset: float, verdict: str
) -> None:
    """With a clock that is wrong by 1 s, the uplift is not compared, and the step names the clock."""
    path = copy_example(tmp_path / "in", ONE_PAIR)
    split_masts(offset)(tmp_path / "in")
    results = validate_example(path, system, tmp_path / "out")
    assert list_verdicts(results)["line_test"] == verdict
    (case,) = (case for case in results.cases if case.id.startswith("pair/"))
    (criterion,) = (row for row in case.criteria if row.quantity == "max_uplift_at_support_mm")
    assert criterion.verdict == verdict
    (source,) = case.sources
    assert (source.record, source.state) == ("measured", "confirmed" if verdict == "pass" else "contradicted")
    wrong = [text for text in case.warnings if "the clock of masts.csv is wrong: its pulses come 1.00 s after" in text]
    assert len(wrong) == (verdict == "skip")
    assert find_discrepancies(results) == []
