"""An element of a line is known to its own file and to the registry only, as far as others need not read it."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any, ClassVar, get_args

import pytest
from pydantic import BaseModel

from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.core.features import find_declaration
from pantocheck.conformance.line import catenary_model, elements
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements.element import Element
from pantocheck.conformance.line.elements.element_registry import ELEMENTS, LineElements
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, Kind

PRODUCT = Path(elements.__path__[0]).parents[1]
"""Folder `conformance`."""

READERS = {
    # Every support has an arm and a messenger support: its layout holds both, and tables import and export both.
    "steady_arm": {"geometry", "line_layout", "line_file", "support_passing", "support_table"},
    "messenger_support": {"geometry", "line_layout", "line_file", "support_table", "curve"},
}
"""Files that read an element beside its own, by key."""


def list_code_words(path: Path) -> set[str]:
    """Words in the names and texts of a program, without its comments and docstrings."""
    tree = ast.parse(path.read_text("utf-8"))
    docstrings = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    words: set[str] = set()
    for node in ast.walk(tree):
        for field in ("id", "attr", "arg", "name"):
            if isinstance(name := getattr(node, field, None), str):
                words.add(name)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            words |= set(re.findall(r"\w+", node.value))
    return words


def list_declared_features(annotation: Any) -> Iterator[str]:
    """Features of the keys of a table and of the tables inside."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        for field in annotation.model_fields.values():
            if (feature := find_declaration(field)) is not None:
                yield feature.name
            yield from list_declared_features(field.annotation)
    for part in get_args(annotation):
        yield from list_declared_features(part)


def list_own_words(element: type[Element]) -> set[str]:
    """Compound names of an element: keys, derived keys and features; those that the model has as well are left out."""
    keys = {key for key in element.__annotations__ if key in element.model_fields}
    features = {name for key in keys for name in list_declared_features(element.model_fields[key].annotation)}
    of_model = {kind.value for kind in Kind} | {field.name for field in fields(Catenary)}
    return {name for name in {*keys, *element.derived, *features} if "_" in name} - of_model


def test_names_of_an_element_stand_in_no_other_file() -> None:
    """Two elements may share a feature."""
    owners: dict[str, set[str]] = {}
    for element in ELEMENTS:
        for word in list_own_words(element):
            owners.setdefault(word, {"element_registry", *READERS.get(word, ())}).add(element.__module__.split(".")[-1])
    assert {"wire_spring", "wire_springs", "point_mass", "stitch_wires"} <= owners.keys()
    files = {path: list_code_words(path) for path in PRODUCT.rglob("*.py")}
    found = [
        f"{path.name}: {word}"
        for path, words in files.items()
        for word in sorted(words & owners.keys())
        if path.stem not in owners[word]
    ]
    assert not found, "\n".join(found)


def test_every_key_of_a_line_belongs_to_one_element() -> None:
    keys = [name for element in ELEMENTS for name in element.model_fields]
    assert len(keys) == len(set(keys)) >= 12
    assert {*keys} == {*LineFile.model_fields} - {"title", "geometry", "note"}
    assert {*ELEMENTS} == {*LineElements.__bases__}


def test_registered_element_acts_on_every_line(monkeypatch: pytest.MonkeyPatch) -> None:
    class Counter(Element):
        calls: ClassVar[int] = 0

        def add_to_line(self, catenary: Catenary) -> Catenary:
            Counter.calls += 1
            assert self.line.geometry.length == catenary.contact_wires[0].end
            return catenary

    monkeypatch.setattr(catenary_model, "ELEMENTS", (*ELEMENTS, Counter))
    build_catenary(build_short_case().line)
    assert Counter.calls == 1


def test_a_line_is_read_without_solvers() -> None:
    """Commands that list or show cases must not load them; model parts without solvers need numpy only."""
    text = "import sys, pantocheck.conformance.line.line_file; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "pantocheck.model.description.catenary" in loaded
    assert (
        not {
            "numba",
            "scipy.linalg",
            "scipy.sparse",
            "scipy.optimize",
            "pantocheck.model.discretisation.discretised_line",
        }
        & loaded
    )
