"""Identity of the suite: digest of its installed files and commit of its repository."""

import hashlib
import subprocess
from functools import cache
from importlib.resources import files
from pathlib import Path

from pantocheck.conformance.core.files import file_digest

PACKAGES = ("pantocheck.conformance", "pantocheck.model", "pantocheck.reference_cases", "pantocheck.templates")
SOURCE_SUFFIXES = frozenset({".py", ".c", ".h", ".toml", ".html", ".typ", ".css", ".js", ".md", ".mplstyle"})
"""Suffixes of the files that determine the results and their pages: code, cases and templates."""


@cache
def suite_digest() -> str:
    """SHA-256 of the installed files of the suite, by their names; equal for a repository and a plain installation."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        folder = Path(str(files(package)))
        paths = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*")}
        for name, path in sorted(paths.items()):
            if path.suffix in SOURCE_SUFFIXES and path.is_file():
                digest.update(f"{package}/{name} {file_digest(path)}\n".encode())
    return f"sha256:{digest.hexdigest()}"


@cache
def find_suite_commit() -> str | None:
    """Commit of the suite if it runs from its own repository, with `-dirty` if files were changed; otherwise None."""
    source = Path(str(files("pantocheck.conformance"))).resolve()
    top = _git(source, "rev-parse", "--show-toplevel")
    # An installed suite may lie inside another repository, whose commit does not identify the suite.
    if top is None or Path(top).resolve() != source.parent:
        return None
    return _git(source, "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*")


def _git(folder: Path, *arguments: str) -> str | None:
    try:
        answer = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True, encoding="utf-8", errors="replace", timeout=10, check=True,
        )  # fmt: skip
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip() or None
