"""The mutated project: its settings, a snapshot of its files, the sample of mutants and the import graph."""

import ast
import hashlib
import os
import shutil
import subprocess
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import cached_property
from pathlib import Path
from typing import Any

from verification.attacks.mutation_mutants import Mutant, compiles, find_mutants

NAMES = ".names"
"""Folder of a tree that holds its packages under their import names."""


@dataclass(frozen=True)
class Settings:
    """`mutation.toml`."""

    seed: int
    areas: dict[str, dict[str, Any]]
    preload: list[str]
    ignored_tests: list[str]
    equivalent: list[dict[str, str]]

    @classmethod
    def read(cls, path: Path) -> "Settings":
        """Read the settings from a TOML file."""
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        return cls(
            table["seed"],
            table["areas"],
            table.get("preload", []),
            table.get("ignored_tests", []),
            table.get("equivalent", []),
        )

    def equivalence(self, mutant: Mutant) -> str | None:
        """Reason why a mutant is equivalent to the original, or None."""
        for entry in self.equivalent:
            same_place = (entry["file"], entry["line"], entry["operator"]) == (
                mutant.file,
                mutant.source,
                mutant.operator,
            )
            if same_place and entry.get("change", mutant.change) == mutant.change:
                return entry["reason"]
        return None


def copy_checkout(root: Path, tree: Path) -> None:
    """Snapshot of a checkout; files that git ignores stay behind."""
    listing = subprocess.run(
        ["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True,
        check=False,
    )
    if listing.returncode == 0:
        for name in sorted(filter(None, listing.stdout.decode().split("\0"))):
            if (root / name).is_file():
                (tree / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / name, tree / name)
    else:
        shutil.copytree(root, tree, ignore=shutil.ignore_patterns("__pycache__"))


def copy_tree(snapshot: Path, tree: Path) -> None:
    """Private copy of a snapshot. Compiled files are linked, because Python and numba replace and never change them."""
    shutil.rmtree(tree, ignore_errors=True)
    for name, folders, files in os.walk(snapshot):
        folder = Path(name)
        if NAMES in folders:
            folders.remove(NAMES)
        target = tree / folder.relative_to(snapshot)
        target.mkdir(parents=True)
        for file in files:
            if folder.name == "__pycache__":
                (target / file).hardlink_to(folder / file)
            else:
                shutil.copy2(folder / file, target / file)
    link_packages(tree)


def link_packages(tree: Path) -> None:
    """Make the packages of a tree importable from its folder of names."""
    for package, folder in packages(tree).items():
        link = tree / NAMES / package.replace(".", "/")
        link.parent.mkdir(parents=True, exist_ok=True)
        link.unlink(missing_ok=True)
        link.symlink_to(tree / folder)


def packages(tree: Path) -> dict[str, str]:
    """Folders of the top packages by their import names, from pyproject.toml."""
    project = tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))
    return project["tool"]["setuptools"]["package-dir"]


@dataclass(frozen=True, eq=False)
class Sources:
    """The sources of a snapshot."""

    tree: Path
    settings: Settings

    def files(self, patterns: Iterable[str]) -> list[str]:
        """Files that match any of the patterns, as paths relative to the tree."""
        found = {path for pattern in patterns for path in self.tree.glob(pattern)}
        return sorted(str(path.relative_to(self.tree)) for path in found if path.suffix == ".py")

    def test_files(self, patterns: list[str]) -> list[str]:
        """Test files below the given files and folders, without the ignored ones."""
        found: set[str] = set()
        for pattern in patterns:
            path = self.tree / pattern
            found.update(
                str(test.relative_to(self.tree)) for test in ([path] if path.is_file() else path.rglob("test_*.py"))
            )
        return sorted(test for test in found if not any(fnmatch(test, name) for name in self.settings.ignored_tests))

    def read(self, file: str) -> bytes:
        """Content of a file of the tree."""
        return (self.tree / file).read_bytes()

    def mutants(self, area: str) -> list[Mutant]:
        """Every mutant of an area, in the order in which a sample takes them: by the digest of seed and id."""
        mutants = [
            mutant
            for file in self.files(self.settings.areas[area]["files"])
            for mutant in find_mutants(file, self.read(file))
        ]
        return sorted(mutants, key=lambda mutant: hashlib.sha256(f"{self.settings.seed}:{mutant.id}".encode()).digest())

    def sample(self, area: str, number: int) -> list[Mutant]:
        """Sample of an area: `number` mutants that compile, and the equivalent ones met on the way."""
        sample, counted = [], 0
        for mutant in self.mutants(area):
            if counted == number:
                break
            if compiles(mutant, self.read(mutant.file)):
                sample.append(mutant)
                counted += self.settings.equivalence(mutant) is None
        return sample

    @cached_property
    def modules(self) -> dict[str, str]:
        """Files of the project by the names of their modules."""
        modules = {}
        for package, folder in packages(self.tree).items():
            for path in (self.tree / folder).rglob("*.py"):
                parts = [package, *path.relative_to(self.tree / folder).with_suffix("").parts]
                modules[".".join(part for part in parts if part != "__init__")] = str(path.relative_to(self.tree))
        return modules

    @cached_property
    def importers(self) -> dict[str, set[str]]:
        """Files that import a file, by file."""
        importers: dict[str, set[str]] = {file: set() for file in self.modules.values()}
        for file in self.modules.values():
            for name in imported_names(ast.parse(self.read(file))):
                if self.modules.get(name, file) != file:
                    importers[self.modules[name]].add(file)
        return importers

    def dependents(self, file: str) -> set[str]:
        """A file and all that import it, directly or through others."""
        found, queue = {file}, [file]
        while queue:
            for importer in self.importers.get(queue.pop(), set()) - found:
                found.add(importer)
                queue.append(importer)
        return found


def imported_names(module: ast.Module) -> Iterator[str]:
    """Names of the modules that a file imports, with imported names that may be modules."""
    for node in ast.walk(module):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
