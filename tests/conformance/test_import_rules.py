"""The layout: import rules, no cycle, one file per name, one meaning per public name."""

import ast
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp
import pytest
from importlinter.cli import lint_imports

ROOT = Path(__file__).parents[2]
FILES = sorted(path for folder in ("model", "conformance") for path in (ROOT / folder).rglob("*.py"))


def test_import_rules_hold(capfd: pytest.CaptureFixture[str]) -> None:
    """The contracts of pyproject.toml; an import inside a function counts like any other."""
    failed = lint_imports(config_filename=str(ROOT / "pyproject.toml"), no_cache=True)
    assert not failed, capfd.readouterr().out


def test_files_do_not_import_in_a_circle() -> None:
    graph = grimp.build_graph("pantocheck.model", "pantocheck.conformance", cache_dir=None)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert len(imports) >= len(FILES)
    assert _find_circle(imports) == []


def test_circle_of_imports_is_found() -> None:
    circle = _find_circle({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}})
    assert circle[0] == circle[-1]
    assert sorted(circle[1:]) == ["a", "b", "c"]


def test_a_file_name_occurs_once() -> None:
    names = [path.name for path in FILES if path.name != "__init__.py"]
    assert not {name for name in names if names.count(name) > 1}


def test_a_public_name_is_defined_once() -> None:
    homes = defaultdict[str, set[str]](set)
    for path in FILES:
        for name in _public_names(ast.parse(path.read_text(encoding="utf-8"))):
            homes[name].add(str(path.relative_to(ROOT)))
    assert not {name: sorted(files) for name, files in homes.items() if len(files) > 1}


def test_every_package_folder_is_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    folders = {path.parent.relative_to(ROOT) for path in FILES} | {Path("reference_cases"), Path("templates")}
    names = {"pantocheck"} | {"pantocheck." + ".".join(folder.parts) for folder in folders}
    assert names == set(project["tool"]["setuptools"]["packages"])


def _find_circle(imports: dict[str, set[str]]) -> list[str]:
    """Modules that import each other in a circle; the first one is also the last. Empty if there is no circle."""
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def _public_names(tree: ast.Module) -> Iterator[str]:
    """Names that a file defines at its top level: functions, classes, constants and type aliases."""
    for node in tree.body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                names = [name]
            case ast.Assign(value=ast.Call(func=ast.Name(id="TypeVar" | "ParamSpec"))):
                names = []  # A type variable has a meaning inside one signature only.
            case ast.Assign(targets=targets):
                names = [target.id for target in targets if isinstance(target, ast.Name)]
            case ast.AnnAssign(target=ast.Name(id=name)):
                names = [name]
            case _:
                names = []
        yield from (name for name in names if not name.startswith("_"))
