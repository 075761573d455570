"""Identity of the suite: digest of its installed files and commit of its repository."""

import hashlib
import os
import subprocess
from functools import cache
from importlib.resources import files
from pathlib import Path

PACKAGES = ("pantocheck.conformance", "pantocheck.model", "pantocheck.reference_cases", "pantocheck.templates")
SOURCE_SUFFIXES = frozenset({".py", ".c", ".h", ".toml", ".html", ".typ", ".css", ".js", ".md", ".mplstyle"})
"""Suffixes of the files that determine the results and their pages: code, cases and templates."""


@cache
def suite_digest() -> str:
    """SHA-256 of the installed files of the suite, by their names; equal for a repository and a plain installation."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        folder = str(files(package))
        paths = [os.path.join(parent, name) for parent, _, names in os.walk(folder) for name in names]
        sources = (path for path in paths if os.path.splitext(path)[1] in SOURCE_SUFFIXES)
        for name, path in sorted((path[len(folder) + 1 :].replace(os.sep, "/"), path) for path in sources):
            with open(path, "rb") as file:
                digest.update(f"{package}/{name} {hashlib.sha256(file.read()).hexdigest()}\n".encode())
    return f"sha256:{digest.hexdigest()}"


@cache
def find_suite_commit() -> str | None:
    """Commit of the suite if it runs from its own repository, with `-dirty` if files were changed; otherwise None."""
    source = Path(str(files("pantocheck.conformance"))).resolve()
    # An installed suite may lie inside another repository, whose commit does not identify the suite.
    if not (source.parent / ".git").exists():
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
