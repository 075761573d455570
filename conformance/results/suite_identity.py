"""Identity of the suite: commit of its repository."""

import subprocess
from functools import cache
from importlib.resources import files
from pathlib import Path


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
            ["git", "-C", str(folder), *arguments], capture_output=True, text=True, timeout=10, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip() or None
