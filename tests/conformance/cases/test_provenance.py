"""Provenance: the library states source and trust of every number; a user's own data need neither."""

import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import BaseModel

from helpers.case_fixtures import EditedCase
from helpers.toml_edit import write_toml
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import list_library, load_case
from pantocheck.conformance.cases.profile_file import list_profiles, load_profile
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_grading import build_ungraded
from pantocheck.conformance.line.library_folder import library_folder

LIBRARY = list_library(library_folder())


def list_tables(tree: Any, name: str) -> Iterator[tuple[str, BaseModel]]:
    """Tables with the key `source`, at all levels, by dotted name."""
    if isinstance(tree, BaseModel):
        if "source" in type(tree).model_fields:
            yield name, tree
        tree = {key: getattr(tree, key) for key in type(tree).model_fields}
    items = tree.items() if isinstance(tree, dict) else enumerate(tree, 1) if isinstance(tree, tuple | list) else ()
    for key, part in items:
        yield from list_tables(part, f"{name}.{key}")


@pytest.mark.parametrize("name", [*sorted(LIBRARY), *sorted(list_profiles())])
def test_library_states_source_and_trust(name: str) -> None:
    parts: Any = load_profile(name) if name in list_profiles() else load_case(LIBRARY[name])
    if isinstance(parts, Case):
        parts = {"": parts.file, "line": parts.line, "pantographs": parts.pantograph_files, "dampings": parts.dampings}
    tables = list(list_tables(parts, name))
    assert len(tables) >= (8 if name in LIBRARY else 1)  # the case and the seven tables of every line
    assert [where for where, table in tables if not {"trust", "source"} <= table.model_fields_set] == []


def without_provenance(tree: Any) -> Any:
    """Content of a TOML file without the keys `trust` and `source`."""
    if isinstance(tree, dict):
        return {key: without_provenance(value) for key, value in tree.items() if key not in {"trust", "source"}}
    return [without_provenance(item) for item in tree] if isinstance(tree, list) else tree


@pytest.fixture
def own_case(edited_case: EditedCase) -> Case:
    """Copy of the 250 km/h case in which no table states trust or source."""
    path = edited_case("250.toml", {"id": "own/250"})
    for name in ("250.toml", "line.toml", "pantograph.toml"):
        file = path.with_name(name)
        write_toml(file, without_provenance(tomllib.loads(file.read_text(encoding="utf-8"))))
    return load_case(path)


def test_own_data_are_shown_as_user_data_of_the_lowest_trust(own_case: Case, case_250: Case) -> None:
    result = build_ungraded(own_case, "skip", "not run")
    shown = {group.group: (group.trust, group.source) for group in result.inputs}
    assert shown["line.contact_wire"] == ("provisional", "user data, no source stated")
    assert {trust for trust, _ in shown.values()} == {"provisional"}
    assert {limit.trust for limit in own_case.limits} == {"own"}
    assert own_case.digest == case_250.digest  # provenance is not part of the inputs


def test_tables_of_a_list_are_numbered_from_one(edited_case: EditedCase) -> None:
    masses = [{"x_m": x, "wire": "contact_wire", "mass_kg": 5.0} for x in (30.0, 40.0)]
    names = load_case(edited_case("line.toml", {"point_mass": masses})).sourced_tables
    assert {"line.point_mass 1", "line.point_mass 2"} == {name for name in names if "point_mass" in name}


@pytest.mark.parametrize(
    ("file", "key"), [("line.toml", "geometry"), ("250.toml", "pantograph.0"), ("250.toml", "limit.0")]
)
def test_trust_needs_a_source(edited_case: EditedCase, file: str, key: str) -> None:
    path = edited_case(file, {f"{key}.source": None, f"{key}.trust": "primary"})
    with pytest.raises(InputError, match=r"source: missing, although the trust is 'primary'"):
        load_case(path)
