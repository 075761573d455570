"""Base tables and messages of validation: types, long values, list items, unions, sources."""

import math
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field, TypeAdapter, ValidationError

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import parse_json, validate_json
from pantocheck.conformance.core.sourced_table import InputTable, NumberList, SourcedTable
from pantocheck.conformance.core.validation_messages import build_input_error
from pantocheck.conformance.drops.drop_sidecar import DropSidecar


class Inner(InputTable):
    kind: Literal["inner"] = "inner"
    depth_m: Annotated[float, Field(ge=1, le=2, description="depth of the part [m]")] = 1.0


class Other(InputTable):
    kind: Literal["other"]
    count: Annotated[int, Field(gt=0, lt=5)]


class Outer(InputTable):
    part: tuple[Annotated[Inner | Other, Field(discriminator="kind")], ...] = Field((), strict=False)
    single: Inner | None = None
    numbers: NumberList | None = None
    name: str = ""
    flag: bool = False
    table: dict[str, float] = Field(default_factory=dict)


def message(content: dict[str, Any]) -> tuple[str, str, str]:
    """Place, finding and hint for content that does not fit."""
    with pytest.raises(ValidationError) as caught:
        Outer.model_validate(content)
    error = build_input_error(caught.value, Outer, "file 'a.toml'")
    return error.where, error.found, error.hint


@pytest.mark.parametrize(
    ("content", "key", "found"),
    [
        ({"single": {"depth_m": 0.5}}, "single.depth_m", "0.5 must be at least 1.0"),
        ({"single": {"depth_m": 2.5}}, "single.depth_m", "2.5 must be at most 2.0"),
        ({"part": [{"kind": "other", "count": 0}]}, "part[1].count", "0 must be greater than 0"),
        ({"part": [{"kind": "inner"}, {"kind": "other", "count": 5}]}, "part[2].count", "5 must be less than 5"),
        ({"part": [{"kind": "other"}]}, "part[1].count", "missing"),
        ({"part": [{"kind": "other", "count": 1.5}]}, "part[1].count", "found 1.5, expected a whole number"),
        ({"part": [{"kind": "other", "count": "1"}]}, "part[1].count", "found '1', expected a whole number"),
        ({"single": {"depth_m": "1.5"}}, "single.depth_m", "found '1.5', expected a number"),
        ({"single": {"depth_m": True}}, "single.depth_m", "found True, expected a number"),
        ({"single": {"depth_m": math.nan}}, "single.depth_m", "nan is not a finite number"),
        ({"single": {"depth_m": -math.inf}}, "single.depth_m", "-inf is not a finite number"),
        ({"single": 3}, "single", "found 3, expected a table"),
        ({"table": 3}, "table", "found 3, expected a table"),
        ({"numbers": 3}, "numbers", "found 3, expected a list"),
        ({"numbers": [1.0, "2"]}, "numbers[2]", "found '2', expected a number"),
        ({"name": 3}, "name", "found 3, expected text in quotes"),
        ({"flag": "yes"}, "flag", "found 'yes', expected true or false"),
        ({"nme": 3}, "nme", "unknown key"),
        ({"single": {"depth_mm": 1500.0}}, "single.depth_mm", "unknown key"),
        ({"x" * 80: 3}, "x" * 80, "unknown key"),
        ({"x" * 81: 3}, "x" * 80 + "...", "unknown key"),
        # The unknown key precedes the other faults, because its hint is the better one.
        ({"name": 3, "single": {"depth": 1.5}}, "single.depth", "unknown key"),
        ({"name": [1.23456789]}, "name", "found [1.23456789], expected text in quotes"),
        ({"flag": 1.23456789}, "flag", "found 1.23457, expected true or false"),
        ({"flag": "x" * 58}, "flag", f"found '{'x' * 58}', expected true or false"),
        ({"flag": "x" * 59}, "flag", f"found '{'x' * 56}..., expected true or false"),
    ],
)
def test_fault_is_named_with_its_key_and_value(content: dict[str, Any], key: str, found: str) -> None:
    where, actual, _ = message(content)
    assert (where, actual) == (f"file 'a.toml', key {key}", found)


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ({"single": {"depth_m": 0.5}}, "It is: depth of the part [m]. Allowed: a number at least 1, at most 2."),
        ({"part": [{"kind": "other"}]}, "Allowed: a whole number greater than 0, less than 5."),
        ({"single": {"depth_mm": 1500.0}}, "Lengths are given in metres: did you mean depth_m = 1.5 ?"),
        ({"tablee": 3}, "Did you mean table ?"),
    ],
)
def test_hint_describes_the_key(content: dict[str, Any], hint: str) -> None:
    assert message(content)[2] == hint


def test_tables_are_frozen_and_strict_where_they_are_known() -> None:
    table = Inner.model_validate({"depth_m": 2})
    assert table.depth_m == 2.0
    with pytest.raises(ValidationError, match="frozen"):
        table.depth_m = 1.0
    # Text in place of a number, infinity and unknown keys are refused. The sidecar cannot be changed.
    channel = {"column": 1, "name": "A", "sensor": 1, "unit": "g", "direction": "+z"}
    sidecar = DropSidecar.model_validate({"record": {"sampling_rate_hz": 50.0}, "channel": [channel]})
    with pytest.raises(ValidationError, match="frozen"):
        sidecar.channel[0].column = 2
    for change in (
        {"sensor": "1"},
        {"position_m": math.inf},
        {"position_m": math.nan},
        {"column": 0},
        {"sensor": -1},
        {"x": 1},
    ):
        with pytest.raises(ValidationError):
            DropSidecar.model_validate({"record": {"sampling_rate_hz": 50.0}, "channel": [channel | change]})
    with pytest.raises(ValidationError) as caught:
        CaseFile.model_validate({"evaluated_spans": [5, "6"]})
    locations = [error["loc"] for error in caught.value.errors()]
    assert ("evaluated_spans", 1) in locations


class Sourced(SourcedTable):
    first_m: float = 0.0
    second_m: float = 0.0


@pytest.mark.parametrize(
    ("provisional", "valid"), [([], True), (["first_m", "second_m"], True), (["first_m", "third_m"], False)]
)
def test_every_provisional_key_is_one_of_the_table(provisional: list[str], valid: bool) -> None:
    content = {"trust": "primary", "source": "own", "provisional": provisional}
    if valid:
        assert Sourced.model_validate(content).provisional == tuple(provisional)
    else:
        with pytest.raises(ValidationError, match="'third_m' is not a key of this table"):
            Sourced.model_validate(content)


@pytest.mark.parametrize(
    ("data", "key"),
    [({"a": [1.0, "x"]}, "a[2]"), ([], "top level"), ({"b": {}}, "b"), ({"a": ["x"], "b": 1}, "a[1]")],
)
def test_first_fault_of_json_is_named(data: Any, key: str) -> None:
    with pytest.raises(InputError) as caught:
        validate_json(data, TypeAdapter(dict[str, list[float]]), "results 'r.json'", "Hint.")
    assert caught.value.where == f"results 'r.json', key {key}"
    assert caught.value.found[0].islower()


def test_fault_of_json_is_named_in_one_short_line() -> None:
    """A file of unknown origin may hold any key."""
    with pytest.raises(InputError) as caught:
        validate_json({"\x1b[31m\n" + "k" * 400: 1}, TypeAdapter(dict[str, list[float]]), "f", "Hint.")
    key = caught.value.where.removeprefix("f, key ")
    assert key == "?[31m " + "k" * 294
    assert parse_json(b'{"a": 1} ', "f", 9) == {"a": 1}
    with pytest.raises(InputError, match="f: has 9 bytes"):
        parse_json(b'{"a": 1} ', "f", 8)
