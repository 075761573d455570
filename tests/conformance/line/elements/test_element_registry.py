"""An element of a line is known to its own file and to the registry only, as far as others need not read it."""

import ast
import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import fields
from inspect import get_annotations
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel

from helpers.listed_spans import list_spans
from helpers.toml_edit import change_keys, write_toml
from pantocheck.conformance.core.features import find_declaration
from pantocheck.conformance.core.key_paths import find_model
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.line import elements
from pantocheck.conformance.line.elements.element import Element
from pantocheck.conformance.line.elements.element_registry import ELEMENTS, LineElements
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_columns import SUPPORT_COLUMNS
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary, Kind
from pantocheck.model.description.catenary import Wire

PRODUCT = Path(elements.__path__[0]).parents[1]
"""Folder `conformance`."""


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


def name_file(model: type[object]) -> str:
    """Name of the file of a class."""
    return model.__module__.split(".")[-1]


def list_declared_features(annotation: Any) -> Iterator[tuple[str, str]]:
    """Features of the keys of a table and of the tables inside, with the names of their files."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        for key, field in annotation.model_fields.items():
            if (feature := find_declaration(field)) is not None:
                home = next(model for model in annotation.__mro__ if key in get_annotations(model))
                yield feature.name, name_file(home)
            yield from list_declared_features(field.annotation)
    for part in get_args(annotation):
        yield from list_declared_features(part)


def list_own_words(element: type[Element]) -> Iterator[tuple[str, str]]:
    """Compound names of an element with their files: keys, derived keys and features that the model does not have."""
    keys, file = [key for key in element.__annotations__ if key in element.model_fields], name_file(element)
    features = [item for key in keys for item in list_declared_features(element.model_fields[key].annotation)]
    of_model = {kind.value for kind in Kind} | {field.name for model in (Catenary, Wire) for field in fields(model)}
    named = [*((key, file) for key in (*keys, *element.derived)), *features, *((name, file) for name, _ in features)]
    return ((name, place) for name, place in named if "_" in name and name not in of_model)


def test_names_of_an_element_stand_in_no_other_file() -> None:
    """Two elements may share a feature."""
    owners: dict[str, set[str]] = {}
    for element in ELEMENTS:
        for word, file in list_own_words(element):
            owners.setdefault(word, {"element_registry"}).add(file)
    assert {"wire_spring", "wire_springs", "point_mass", "stitch_wires"} <= owners.keys()
    named = re.compile("|".join(owners))
    files = {path: list_code_words(path) for path in PRODUCT.rglob("*.py") if named.search(path.read_text("utf-8"))}
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


def find_gaps(element: type[Element]) -> Iterator[str]:
    """Parts of a declaration that lack their counterpart."""
    own = vars(element)
    if bool(element.derived) != ("derive" in own):
        yield "derived keys need the method `derive`"
    if (element.symbol is not None) != ("mark" in own):
        yield "a symbol needs the method `mark`"
    for key, field in element.model_fields.items():
        table = find_model(field.annotation, set())[0]
        if table is None or not table.__doc__:
            yield f"{key} is not a table with a docstring"
        if not field.is_required() and find_declaration(field) is None:
            yield f"{key} has a default, but no feature"
        if key in element.support_tables and table is not None:
            columns = {f"{key}_{name}" for name in table.model_fields if name not in PROVENANCE}
            yield from (f"no column {name}" for name in columns - {*SUPPORT_COLUMNS})
    yield from (f"no key {key} for single supports" for key in {*element.support_tables} - {*element.model_fields})


def test_every_element_is_declared_completely() -> None:
    """Keys are tables with features; symbols, derived values and columns of single supports have all their parts."""
    gaps = [f"{element.__name__}: {gap}" for element in ELEMENTS for gap in find_gaps(element)]
    assert not gaps, "\n".join(gaps)
    own = Counter(name for element in ELEMENTS for name in vars(element).keys() - vars(Element).keys())
    clashes = {name for name, count in own.items() if count > 1 and not name.startswith("__")}
    assert not clashes, "one of these would hide the other on every line"
    symbols = [element.symbol for element in ELEMENTS if element.symbol is not None]
    assert len({symbol.name for symbol in symbols}) == len({symbol.marker for symbol in symbols}) == len(symbols) >= 4
    derived = [key for element in ELEMENTS for key in element.derived]
    assert len(derived) == len(set(derived)) >= 9


TRIAL = """
import json
from pathlib import Path

from helpers.insulator_element import register

register()
from helpers.line_table_files import export_and_import
from pantocheck.conformance.core.features import list_features
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary, discretise_line
from pantocheck.conformance.line.catenary_model import build_derived_line
from pantocheck.conformance.line.line_drawing import LineDrawing, paint_rows
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_shape import build_line_shape, list_connections
from pantocheck.conformance.pages.line_figure import draw_line_shape

line = read_model(Path("line.toml"), LineFile, "line")
imported, tree = export_and_import(Path(), Path("line.toml"))
built = discretise_line(line, 2.0)
drawing = LineDrawing(built, "Line", line.geometry)
shape = build_line_shape(line, (2, 2), built)
derived = build_derived_line(line, built)
try:
    read_model(Path("lost.toml"), LineFile, "line")
except InputError as error:
    lost = str(error)
print(json.dumps({
    "masses": [mass.mass for mass in built.catenary.point_masses],
    "springs": [spring.stiffness for spring in built.catenary.springs],
    "derived": [len(derived.wire_springs), len(derived.point_masses)],
    "connected": len(list_connections(built.catenary)) - len(built.catenary.droppers),
    "same": build_catenary(imported) == build_catenary(line),
    "support": tree["geometry"]["support"],
    "features": sorted({*list_features(line)} & {"insulators", "single_supports"}),
    "legend": [text.get_text() for text in paint_rows(drawing, drawing.rows, 10.0).legends[0].get_texts()],
    "symbols": [symbol.name for symbol in shape.symbols],
    "figure": draw_line_shape(shape, None)[:4],
    "lost": lost,
}))
"""
"""Use of the trial element in a process of its own: tables, features and drawings know the elements when they load."""


SPRING, MASS = {"x_m": 90.0, "stiffness_N_m": 5e4}, {"x_m": 90.0, "wire": "contact_wire", "mass_kg": 3.0}


def test_new_element_takes_one_file_and_one_base_of_the_registry(tmp_path: Path) -> None:
    """Insulators of 5 kg, at support 2 of 8 kg: a column of the line tables, a symbol of both drawings, a feature.

    Springs and masses of another element remain its own: programs receive one of each, and one spring is drawn.
    """
    tables = list_spans(read_toml(library_folder() / "en50318-2002" / "line.toml", "line"))
    change_keys(tables, {"geometry.span_list": tables["geometry"]["span_list"][:4]})
    tables["geometry"]["support"] = [{"number": 2, "insulator": {"mass_kg": 8.0}}]
    write_toml(tmp_path / "lost.toml", tables)
    write_toml(
        tmp_path / "line.toml", tables | {"insulator": {"mass_kg": 5.0}, "wire_spring": [SPRING], "point_mass": [MASS]}
    )
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])}
    done = subprocess.run(
        [sys.executable, "-c", TRIAL], capture_output=True, text=True, cwd=tmp_path, env=environment, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found.pop("lost").startswith("line 'lost.toml', key geometry.support[1].insulator")
    assert found == {
        "masses": [3.0, 5.0, 8.0, 5.0],
        "springs": [5e4, 1e3, 1e3, 1e3],
        "derived": [1, 1],
        "connected": 1,
        "same": True,
        "support": [{"number": 2, "insulator": {"mass_kg": 8.0}}],
        "features": ["insulators", "single_supports"],
        "legend": ["insulator", "messenger support", "steady arm", "anchor"],
        "symbols": ["insulator", "messenger support", "steady arm", "anchor", "mass"],
        "figure": "<svg",
    }
    assert "insulator_mass_kg" in (tmp_path / "supports.csv").read_text().splitlines()[0]


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
