"""Examples of the gallery: each runs as a script, asserts a number, and uses the public interface only."""

import ast
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"
EXAMPLES = sorted(GALLERY.glob("*.py"))
PUBLIC = {"pantocheck.conformance", "pantocheck.model"}


@pytest.mark.thorough
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path: Path, tmp_path: Path) -> None:
    """In a fresh process, without a display, as a reader runs it."""
    done = subprocess.run(
        [sys.executable, str(path)], cwd=tmp_path, env={**os.environ, "MPLBACKEND": "agg"}, capture_output=True,
        text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_asserts_a_number(path: Path) -> None:
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    asserted = [number for node in nodes if isinstance(node, ast.Assert) for number in ast.walk(node)]
    assert any(isinstance(number, ast.Constant) and isinstance(number.value, int | float) for number in asserted)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_uses_the_public_interface_only(path: Path) -> None:
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    imported = {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module is not None}
    imported |= {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    assert {name for name in imported if name.startswith("pantocheck")} <= PUBLIC


def test_gallery_begins_with_lines_and_ends_with_measurements(monkeypatch: pytest.MonkeyPatch) -> None:
    """An example without a place in the order stands last."""
    monkeypatch.syspath_prepend(str(GALLERY.parents[1] / "docs"))
    order = import_module("site_pages.gallery_order").GalleryOrder(GALLERY)
    names = [path.stem for path in sorted([*EXAMPLES, GALLERY / "aaa.py"], key=order)]
    assert (names[0], names[-1]) == ("own_line", "aaa")
    assert names.index("two_pantographs") < names.index("damping_fit")
