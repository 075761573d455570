"""Registry: only its own file and the registry know an element by name."""

import re
import subprocess
import sys
from pathlib import Path
from typing import ClassVar

import pytest

from pantocheck.conformance.app.self_test.adapter_check import build_short_case
from pantocheck.conformance.core.features import find_declaration
from pantocheck.conformance.line import catenary_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.elements import element_registry
from pantocheck.conformance.line.elements.element import Element
from pantocheck.conformance.line.elements.element_registry import ELEMENTS, LineElements
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import Catenary

CONFORMANCE = Path(element_registry.__file__).parents[2]
FOLDER = Path(element_registry.__file__).parent
OUTSIDE = {path: path.read_text(encoding="utf-8") for path in CONFORMANCE.rglob("*.py") if FOLDER not in path.parents}


def optional_keys() -> list[str]:
    """Keys of elements that a line need not have."""
    keys = {name: field for element in ELEMENTS for name, field in element.model_fields.items()}
    return [name for name, field in keys.items() if not field.is_required()]


def test_every_key_of_a_line_belongs_to_one_element() -> None:
    keys = [name for element in ELEMENTS for name in element.model_fields]
    assert len(keys) == len(set(keys)) >= 12
    assert {*keys} == {*LineFile.model_fields} - {"title", "geometry", "note"}
    assert {*ELEMENTS} == {*LineElements.__bases__}


@pytest.mark.parametrize("key", optional_keys())
def test_optional_element_is_not_known_outside_its_folder(key: str) -> None:
    """Its key is not read from a line there, and its file is not imported."""
    [element] = [element for element in ELEMENTS if key in element.model_fields]
    use = re.compile(rf"\b(line|file)\.{key}\b")
    module = "" if key in ("section", "overlap") else element.__module__
    known = [path.name for path, text in OUTSIDE.items() if use.search(text) or (module and module in text)]
    assert known == []


def test_names_of_features_stand_in_the_files_of_elements_only() -> None:
    """Names that no other subject uses as a word."""
    names = {
        feature.name
        for element in ELEMENTS
        for field in element.model_fields.values()
        if (feature := find_declaration(field)) is not None and "_" in feature.name
    }
    assert {"point_masses", "wire_springs", "stitch_wire"} <= names
    named = [(path.name, name) for path, text in OUTSIDE.items() for name in names if f'Feature("{name}"' in text]
    assert named == []


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
