"""Public interface for scripts: names, changes of inputs, tables, figures and files."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pantocheck.conformance
from helpers.wave_system import SIGMA, Wave
from pantocheck.conformance import (
    GradedResults,
    InputError,
    OpenedCase,
    SimulatedRun,
    list_cases,
    open_case,
    open_pantograph,
    open_results,
    open_run,
)
from pantocheck.conformance.app.notebook import display
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.comparison.compared_run import describe_delivery
from pantocheck.conformance.execution.runner import run_cases

PAGE = Path(__file__).parents[3] / "docs" / "python.md"
PUBLIC_NAMES = """
    ComparedRuns FittedDamping FittedPantograph GradedResults IdentifiedLines IdentifiedRecords InputError
    OpenedCase OpenedDrop OpenedLine OpenedPantograph OpenedRun SimulatedRun VerifiedReport assess_run
    build_case compare_runs fit_pantograph grade_cases identify_line list_cases open_case open_drop open_line
    open_modes open_pantograph open_results open_run read_traces run_campaign validate_dossier verify_report
"""


@pytest.fixture
def run(two_pantograph_case: Case) -> SimulatedRun:
    """Run of two pantographs with known quantities."""
    system = Wave()
    delivered = system.run(two_pantograph_case)
    facts = describe_delivery(two_pantograph_case, system, delivered)
    return SimulatedRun(facts, two_pantograph_case, system, delivered.record)


def read_column(table: Any, name: str) -> list[Any]:
    return list(table[name])


def test_every_public_name_is_kept_and_documented() -> None:
    """Scripts of users name them; the reference of the documentation lists all of `__all__`."""
    assert PUBLIC_NAMES.split() == sorted(pantocheck.conformance.__all__)
    assert all(getattr(pantocheck.conformance, name).__doc__ for name in pantocheck.conformance.__all__)


def test_import_loads_no_heavy_package() -> None:
    """A script that reads records does not wait for numba, matplotlib or scipy.signal."""
    heavy = "'numba', 'matplotlib', 'scipy'"
    code = f"import sys, pantocheck.conformance; print([name for name in ({heavy}) if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_changed_case_is_another_value() -> None:
    case = open_case("en50318-2002/250")
    changed = case.with_({"line.contact_wire.tension_N": 21_000.0}, speed_km_h=260).with_(speed_km_h=270)
    assert (case.inputs["case"]["speed_km_h"], changed.inputs["case"]["speed_km_h"]) == (250, 270)
    assert changed.inputs["line"]["contact_wire"]["tension_N"] == 21_000
    assert changed.case.digest != case.case.digest
    assert len(changed.case.changes) == 2
    assert open_case("en50318-2002/250") == open_case("en50318-2002/250")
    assert isinstance(open_case("en50318-2002/250"), OpenedCase)


@pytest.mark.parametrize(
    ("changes", "message"),
    [({"speed_kmh": 300}, "speed_km_h"), ({"speed_km_h": "fast"}, "speed_km_h"), ({"id": "mine"}, "cannot be changed")],
)
def test_a_wrong_change_is_named(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        open_case("en50318-2002/250").with_(changes)


def test_library_is_listed_and_one_case_is_opened() -> None:
    assert "en50318-2018/ac-simple/320-twin" in list_cases()
    with pytest.raises(InputError, match="2 cases have this name"):
        open_case("en50318-2002/*")
    with pytest.raises(InputError, match="Choose a case with a train"):
        open_case("en50318-2018/ac-simple/static").simulate()


def test_quantities_are_a_table_with_their_unit_and_unknown_components(run: SimulatedRun) -> None:
    table = run.to_dataframe()
    rows = zip(*(read_column(table, name) for name in ("pantograph", "quantity", "value")), strict=True)
    values = {(owner, name): value for owner, name, value in rows}
    assert values[2, "std_force_N"] == run.quantity("std_force_N", 2) == pytest.approx(SIGMA, rel=1e-3)
    assert values[0, "max_uplift_at_support_mm"] == run.quantity("max_uplift_at_support_mm", 0)
    assert run.pantographs == (1, 2)
    # A terminal of 80 columns shows the first columns of a table of pandas; a label is up to 60 characters long.
    columns = ["pantograph", "quantity", "value", "unit", "uncertainty", "unknown_components", "label"]
    assert list(run.to_dataframe()) == columns
    # The wave has no other start, and its section is shorter than the five spans that the component `length` needs.
    assert set(read_column(run.to_dataframe(), "unknown_components")) == {"start, length"}


def test_values_are_described_in_one_line(run: SimulatedRun, two_pantograph_case: Case) -> None:
    case = open_case("en50318-2018/ac-simple/320-twin").with_({"line.contact_wire.tension_N": 21e3}, speed_km_h=300.0)
    described = f"<OpenedCase {case.id}, 300 km/h, 2 pantographs, changed: line.contact_wire.tension_N speed_km_h"
    assert repr(case).startswith(described)
    assert repr(open_case("en50318-2018/ac-simple/static")).startswith(
        "<OpenedCase en50318-2018/ac-simple/static, at rest, line: EN 50318:2018"
    )
    assert repr(case.line).startswith("<OpenedLine 48 spans, 2640 m, elements of 0.5 m, EN 50318:2018 AC simple")
    pantograph = open_pantograph("en50318-2018/pantograph.toml")
    assert repr(pantograph) == f"<OpenedPantograph pantograph.toml, {pantograph.file.title}>"
    speed = f"{two_pantograph_case.file.speed_km_h:g} km/h, 2 pantographs"
    assert repr(run).startswith(f"<SimulatedRun {two_pantograph_case.id}, {speed}, system: ")
    graded = GradedResults(run_cases([two_pantograph_case], Wave()))
    assert repr(graded).startswith(f"<GradedResults {graded.verdict}, 1 case, system: ")
    assert max(len(repr(each)) for each in (case, case.line, pantograph, run, graded)) < 180


def test_run_is_written_read_and_drawn(run: SimulatedRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sidecar = run.write(tmp_path / "run.h5")
    again = open_run(sidecar)
    assert again.quantity("std_force_N", 2) == pytest.approx(run.quantity("std_force_N", 2), rel=1e-6)
    axes = run.plot(2)
    assert len(axes.lines) == 2
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), run.run.signals[2].delivered)
    (line,) = run.plot_spectrum(1, axes=axes.figure.add_subplot()).lines
    assert line.get_xdata().max() <= 50
    monkeypatch.setattr(display.importlib.util, "find_spec", lambda name: None)
    signals = run.signals(2)
    assert list(signals) == ["position_m", "force_N", "force_20_N", "contact_height_m"]
    assert {values.shape for values in signals.values()} == {signals["force_N"].shape}
    assert np.std(signals["force_20_N"]) == pytest.approx(SIGMA, rel=1e-3)


def test_results_have_criteria_and_files(two_pantograph_case: Case, tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_bytes(run_cases([two_pantograph_case], Wave()).to_json())
    graded = open_results(path)
    assert graded.verdict == graded.results.verdict
    assert "std_force_N" in read_column(graded.to_dataframe(), "quantity")
    names = [file.name for file in graded.write(tmp_path / "out", ("md", "csv"))]
    assert names == ["results.json", "quantities.csv", "summary.md"]


def test_sweep_of_the_page_is_short_and_uses_public_names_only() -> None:
    """A sweep over one's own line takes at most ten lines and no internal import."""
    sweep = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[0]
    assert len(sweep.splitlines()) <= 10
    for module, names in re.findall(r"from ([\w.]+) import ([\w, ]+)", sweep):
        assert module == "pantocheck.conformance"
        assert {name.strip() for name in names.split(",")} <= set(pantocheck.conformance.__all__)
