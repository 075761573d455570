"""New files: templates are valid, their comments state the bounds of the keys, and the new case can be simulated."""

import re
import tomllib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands.new_command import NEW_KINDS, SHEET_KINDS, NewKind, read_template
from pantocheck.conformance.app.file_check import check_input_file
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.comparison.static_record import StaticSidecar
from pantocheck.conformance.core.key_paths import find_field, key_adapter, list_models
from pantocheck.conformance.core.spreadsheet import read_spreadsheet
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.core.validation_messages import list_bounds
from pantocheck.conformance.dossier.dossier_file import DossierFile
from pantocheck.conformance.drops.drop_sidecar import DropChannelTable
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_import import import_line
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.pantograph.response_record import ResponseSidecar
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered

MODELS: dict[NewKind, type[BaseModel]] = {
    "line": LineFile, "case": CaseFile, "pantograph": PantographFile, "response": ResponseSidecar,
    "static": StaticSidecar, "administration": Administration, "dossier": DossierFile,
}  # fmt: skip

new = partial(pantocheck, "new")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Empty folder, in which the commands run."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", NEW_KINDS)
def test_new_file_alone_is_valid(kind: str, folder: Path) -> None:
    result = new(kind, "my file.toml")
    assert (result.exit_code, result.stderr) == (0, "")
    assert check_input_file(folder / "my file.toml").startswith(kind)


def test_new_case_names_the_files_beside_it(folder: Path) -> None:
    for kind in ("line", "pantograph", "case"):
        assert new(kind).exit_code == 0
    assert new("case", "other.toml", "--line", "en50318-2018/ac-simple/line.toml").exit_code == 0
    case, other = load_case(folder / "case.toml"), load_case(folder / "other.toml")
    assert (case.id, case.line.title, case.pantographs[0].title) == ("own/case", "My line", "My pantograph")
    assert (other.id, other.pantographs) == ("own/other", case.pantographs)
    assert other.line.title.startswith("EN 50318:2018 AC simple")


def test_new_case_can_be_simulated(folder: Path) -> None:
    """The mean force is the uplift force, but for the base spring of 50 N/m under an uplift of some centimetres."""
    for kind in ("line", "pantograph", "case"):
        new(kind)
    outcome = ReferenceSimulator().run_unrefined(load_case(folder / "case.toml"))
    assert isinstance(outcome, Delivered)
    assert outcome.record is not None
    x, force = outcome.record.position[0], outcome.record.force[0]
    start, end = load_case(folder / "case.toml").analysis_section
    assert np.mean(force[(start <= x) & (x < end)]) == pytest.approx(120, abs=5)


def test_no_file_is_overwritten(folder: Path) -> None:
    (folder / "line.toml").write_text("mine")
    result = new("line")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "file 'line.toml': exists already" in result.stderr
    assert (folder / "line.toml").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["lin"], "Did you mean line ?"),
        (["line", "line.txt"], "has the suffix '.txt'"),
        (["line", "--line", "other.toml"], "given for a line"),
    ],
)
def test_wrong_arguments_are_refused(arguments: list[str], message: str, folder: Path) -> None:
    result = new(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert list(folder.iterdir()) == []


def test_names_with_quotes_keep_the_case_readable(folder: Path) -> None:
    new("line", 'a"b.toml')
    assert new("case", "--line", 'a"b.toml').exit_code == 0
    assert load_case(folder / "case.toml").line.title == "My line"


@pytest.mark.parametrize("kind", SHEET_KINDS)
def test_new_sheets_can_be_used_at_once(kind: str, folder: Path) -> None:
    """The sheets of a line give the line of the template; that of static values has its sidecar."""
    assert new(kind, "new.xlsx").exit_code == 0
    assert new(kind, "new.xlsx").exit_code == 2  # nothing is overwritten
    if kind == "line":
        new("line")
        line = import_line(folder / "line.toml", folder / "new.xlsx", None)
        assert build_catenary(LineFile.model_validate(line)) == build_catenary(
            read_model(folder / "line.toml", LineFile, "line")
        )
    elif kind == "static":
        assert check_input_file(folder / "new.toml").startswith("static record: 3 positions")
    else:
        assert read_spreadsheet(folder / "new.xlsx").head.cells == tuple(DropChannelTable.model_fields)


def uncomment(text: str) -> str:
    """Template whose commented keys and tables are in use."""
    return re.sub(r"^# (?=\[|\w+ = )", "", text, flags=re.MULTILINE)


@pytest.mark.parametrize("kind", NEW_KINDS)
def test_commented_keys_are_valid_too(kind: NewKind, folder: Path) -> None:
    new("line")
    text = uncomment(read_template(kind)).replace("@id@", "own/a").replace("@line@", "line.toml")
    (folder / "all.toml").write_text(text.replace("@pantograph@", "en50318-2002/pantograph.toml"))
    if kind == "dossier":  # it names measurements, which are not there
        assert read_model(folder / "all.toml", DossierFile, kind).pair
        return
    assert check_input_file(folder / "all.toml").startswith(kind)


def list_numbers(model: type[BaseModel], tree: dict[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Keys with numbers in a tree, with their bounds in words."""
    for key, value in tree.items():
        table = next((each for each in list_models(model) if find_field(each, key) is not None), None)
        if table is None:
            continue
        name = find_field(table, key)
        assert name is not None
        nested = list_models(table.model_fields[name].annotation)
        for part in value if isinstance(value, list) else [value]:
            if isinstance(part, dict):
                for member in nested:
                    yield from list_numbers(member, part)
        schema = key_adapter(table, name).json_schema()
        for member in (schema, *schema.get("anyOf", ())):
            if bounds := list_bounds(member.get("items", member)):
                yield key, bounds


@pytest.mark.parametrize("kind", NEW_KINDS)
def test_comments_state_the_bounds_of_every_number(kind: NewKind) -> None:
    """The bounds stand on the line of the key, or on a comment line that names the key."""
    text = read_template(kind)
    numbers = list(list_numbers(MODELS[kind], tomllib.loads(text)))
    fewest = {"line": 20, "case": 2, "pantograph": 3, "response": 2, "static": 2, "administration": 0, "dossier": 2}
    assert len(numbers) >= fewest[kind]
    missing = [
        (key, bounds)
        for key, bounds in numbers
        if not any(key in line and ", ".join(bounds) in line for line in text.splitlines())
    ]
    assert missing == []
