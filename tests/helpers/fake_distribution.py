"""Installed distribution without an installation: a package and its metadata in a folder on `sys.path`."""

import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Folder of installed packages; modules that a test imports from it are forgotten."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    yield folder
    for name, module in [*sys.modules.items()]:
        if str(folder) in str(getattr(module, "__file__", "")):
            del sys.modules[name]


def write_distribution(
    site: Path, name: str, version: str, entries: Mapping[str, Mapping[str, str]], files: Mapping[str, str]
) -> None:
    """Write a distribution.

    Args:
        site: Folder of installed packages.
        name, version: Name and version of the distribution.
        entries: Value of every entry point by its group and name.
        files: Texts of the files of its packages by their paths.
    """
    metadata = site / f"{name.replace('-', '_')}-{version}.dist-info"
    lines = [line for group, row in entries.items() for line in (f"[{group}]", *(f"{k} = {row[k]}" for k in row))]
    contents = {
        metadata / "METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        metadata / "entry_points.txt": "\n".join(lines),
        **{site / path: text for path, text in files.items()},
    }
    for path, text in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
