"""Changes of TOML files by key, so that a test does not depend on the text of a file."""

import tomllib
from pathlib import Path
from typing import Any

import tomli_w


def edit_toml(path: Path, changes: dict[str, Any]) -> Path:
    """Set values by dotted key, such as `limit.1.lower`; None removes a key. Items of a list count from 0."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    for key, value in changes.items():
        *tables, last = key.split(".")
        table: Any = content
        for name in tables:
            table = table[int(name)] if isinstance(table, list) else table[name]
        if value is None:
            del table[last]
        else:
            table[int(last) if isinstance(table, list) else last] = value
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path
