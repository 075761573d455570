"""Values of inputs in results.json."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from pantocheck.conformance.app.commands.command_list import app
from pantocheck.conformance.cases.library import load_case, select_cases
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.results.case_facts_format import StoredRange


def test_library_case_has_the_values_of_its_files() -> None:
    [case] = select_cases(["en50318-2002/250"])
    groups = {group.group: group.values for group in build_ungraded(case, "skip", "not run").inputs}
    assert groups["case"]["speed_km_h"] == 250
    assert groups["line.contact_wire"]["tension_N"] == 20000
    assert groups["pantograph 1.chain"]["masses_kg"] == [15, 7.2]
    assert groups["line.geometry.encumbrance_m"] == {}
    assert not {"source", "trust", "title", "id"} & {key for values in groups.values() for key in values}


def test_spans_are_listed_up_to_twelve_and_summarised_beyond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Dropper schedules by name keep their names."""
    monkeypatch.chdir(tmp_path)
    for kind in ("line", "pantograph", "case"):
        CliRunner().invoke(app, ["new", kind])
    text = Path("line.toml").read_text()
    [case] = select_cases(["case.toml"])
    [geometry] = [g.values for g in build_ungraded(case, "skip", "").inputs if g.group == "line.geometry"]
    assert geometry["span_list.length_m"] == [60, 60, 60, 54, 60, 60, 54, 60, 60, 60, 60, 60]
    assert geometry["span_list.droppers"] == ["short", "short"]
    Path("line.toml").write_text(text.replace("span_list = [ ", "span_list = [ { length_m = 65.0 },"))
    [geometry] = [
        g.values for g in build_ungraded(load_case(Path("case.toml")), "skip", "").inputs if g.group == "line.geometry"
    ]
    assert geometry["span_list.length_m"] == StoredRange(count=13, lowest=54, highest=65)
