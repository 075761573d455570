"""List of the cases of the library."""

import re
from functools import cache
from pathlib import Path

_ID = re.compile(r"^id\s*=", re.MULTILINE)


@cache
def list_library(folder: Path) -> dict[str, Path]:
    """Files of all cases below a folder, by id; the id of a case is its path in the folder."""
    # Lines, pantographs and the bibliography are in the same folders; only a case file has an id.
    return {
        path.relative_to(folder).with_suffix("").as_posix(): path
        for path in sorted(folder.rglob("*.toml"))
        if _ID.search(path.read_text(encoding="utf-8"))
    }
