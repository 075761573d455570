"""Refused input of every command: one message with the place, exit code 2, no traceback, and no trace of an output."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click import Parameter

from helpers.command_line import pantocheck
from pantocheck.conformance.app.commands.command_list import COMMANDS, load_command
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import parse_json
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.results.results_format import Results

BROKEN = {
    "empty.toml": b"",
    "broken.toml": b"[",
    "broken.json": b"{",
    "broken.csv": b"time_s,force_1_N\n0,1\n\xff\xfe,",
    "deep.json": b"[" * 100_000,
    "twice.json": b'{"schema": "pantocheck.results/1", "schema": "pantocheck.results/1"}',
    "twice.toml": b"id = 1\nid = 2\n",
}
"""Damaged files by name; every command gets each of them in place of all its inputs."""

FURTHER = {"new": ["nothing"], "schema": ["nothing"], "doctor": ["--timeout", "x"], "cases": ["--cases", "{file}"]}
"""Arguments of the commands that read no file."""


def list_commands(wanted: Callable[[Parameter], bool]) -> list[str]:
    return [name for name in COMMANDS if any(map(wanted, load_command(name).params))]


def build_call(name: str, file: Path, out: Path) -> list[str]:
    """Call of a command with one file in place of all its required inputs, and with its output."""
    call = name.split()
    for parameter in load_command(name).params:
        if parameter.name in ("out", "write_verifier"):
            call += [parameter.opts[0], str(out)] if parameter.name == "out" else []
        elif parameter.param_type_name == "argument":
            call += [str(file)] * (2 if parameter.nargs == -1 else 1)
        elif parameter.required:
            call += [parameter.opts[0], str(file)]
    return call


OUTPUTS = list_commands(lambda parameter: parameter.name == "out")


def test_most_commands_have_an_output() -> None:
    assert len(OUTPUTS) > 15


@pytest.mark.parametrize("name", OUTPUTS)
def test_refused_input_leaves_no_output(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder of its own, two levels deep, is neither made nor left; the folder of the input keeps its files."""
    monkeypatch.chdir(tmp_path)
    for file, content in {**BROKEN, "missing.toml": None}.items():
        if content is not None:
            (tmp_path / file).write_bytes(content)
        before = sorted(tmp_path.iterdir())
        ended = pantocheck(*build_call(name, tmp_path / file, tmp_path / "new" / "deep" / "out.csv"))
        assert ended.exit_code == 2, (file, ended.output)
        assert "Traceback" not in ended.output
        assert "internal error" not in ended.output
        if name == "runs import":  # keeps a list of the files that it refused
            assert not list((tmp_path / "new").rglob("*.parquet")), file
            shutil.rmtree(tmp_path / "new", ignore_errors=True)
        assert sorted(tmp_path.iterdir()) == before, (file, ended.output)


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ('{"a": {"b": "\\ud800"}}', "key a.b: has half of a surrogate pair at character 1"),
        ('{"a": ["", "x\\udc00"]}', "key a[2]: has half of a surrogate pair at character 2"),
        ('{"\\ud800": 1}', "has half of a surrogate pair"),
        (f'{{"a": [1, {2**80}]}}', "key a[2]: is a whole number of 81 bits"),
        ('{"a": -9223372036854775809}', "key a: is a whole number of 64 bits"),
        (f'{{"a": {"9" * 5000}}}', "is not valid JSON (Exceeds the limit"),
        ('{"a": NaN}', "key a: nan is not a finite number"),
        ('{"a": {"b": -Infinity}}', "key a.b: -inf is not a finite number"),
        ('{"a": 1e999}', "key a: inf is not a finite number"),
        ('{"a": {"b": 1, "b": 2}}', "is not valid JSON (key 'b' occurs twice)"),
        ("[" * 100_000, "is not valid JSON"),
        ('{"a":' * 100_000, "is not valid JSON"),
    ],
)
def test_value_that_programs_read_differently_is_refused_in_json(content: str, text: str) -> None:
    with pytest.raises(InputError, match=re.escape(f"file 'a.json'{', ' * text.startswith('key')}")) as caught:
        parse_json(content.encode("utf-8", "surrogatepass"), "file 'a.json'", 10**7)
    assert text in str(caught.value)


def test_raw_surrogates_are_refused_and_true_pairs_read() -> None:
    with pytest.raises(InputError, match=r"key a: has half of a surrogate pair"):
        parse_json(b'{"a": "\xed\xa0\x80"}', "file 'a.json'", 100)
    assert parse_json(b'{"a": "\\ud83d\\ude84", "b": 9223372036854775807}', "file", 100)["a"] == "\U0001f684"


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (f"a.b = [1, {2**80}]", "key a.b[2]: is a whole number of 81 bits"),
        (f"a = {'9' * 400}", "key a: is a whole number of 1329 bits"),
        ("a = [{ b = nan }]", "key a[1].b: nan is not a finite number"),
        ("a = -inf", "key a: -inf is not a finite number"),
        ('a = "\\ud800"', "is not valid TOML"),
        ("a = 1\na = 2", "is not valid TOML: Cannot overwrite a value"),
    ],
)
def test_value_that_programs_read_differently_is_refused_in_toml(line: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(line + "\n")
    with pytest.raises(InputError, match=re.escape(text)):
        read_toml(tmp_path / "a.toml", "case")


Change = Callable[[dict[str, Any]], object]

LENGTHS: dict[str, tuple[Change, str]] = {
    "force": (lambda c: c["traces"]["1"]["force_N"].pop(), "traces.1"),
    "filtered force": (lambda c: c["traces"]["1"]["force_20_N"].pop(), "traces.1"),
    "position": (lambda c: c["traces"]["1"].update(position_m=[]), "traces.1"),
    "spectrum": (lambda c: c["traces"]["1"]["spectrum"]["amplitude_N"].pop(), "traces.1.spectrum"),
    "histogram": (lambda c: c["traces"]["1"]["histogram"]["edges_N"].pop(), "traces.1.histogram"),
    "uplift": (lambda c: c["uplift"][0]["time_s"].pop(), "uplift[1]"),
}


@pytest.mark.parametrize("command", ["site", "compare", "verify"])
@pytest.mark.parametrize("name", LENGTHS)
def test_curves_of_unequal_lengths_are_refused(command: str, name: str, results: Any, tmp_path: Path) -> None:
    change, place = LENGTHS[name]
    sound, damaged = tmp_path / "sound.json", tmp_path / "bad" / "results.json"
    sound.write_bytes(Results.model_validate(results).to_json())
    change(results["cases"][0])
    damaged.parent.mkdir()
    damaged.write_text(json.dumps(results))
    arguments = {"site": [damaged.parent], "compare": [sound, damaged], "verify": [damaged]}[command]
    out = [] if command == "verify" else ["--out", tmp_path / "out"]
    ended = pantocheck(command, *arguments, *out)
    assert ended.exit_code == 2
    assert f"key cases[1].{place}" in ended.output
    assert "expected one length" in ended.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_refuses_every_damaged_file(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A whole number, a text and a table that no program reads alike, in each format, in place of every input."""
    monkeypatch.chdir(tmp_path)
    files = {
        "number.toml": f"a = {2**80}\n", "number.json": f'{{"a": {2**80}}}', "text.json": '{"a": "\\ud800"}',
        "deep.toml": "a = " + "[" * 5000, "long.json": "9" * 5000, "nan.json": '{"a": NaN}',
    }  # fmt: skip
    for file, content in files.items():
        (tmp_path / file).write_text(content)
        call = [part.format(file=file) for part in FURTHER.get(name, [])]
        ended = pantocheck(*(name.split() + call if call else build_call(name, tmp_path / file, tmp_path / "out")))
        assert ended.exit_code == 2, (file, ended.output)
        assert not re.search("Traceback|internal error", ended.output), (file, ended.output)
