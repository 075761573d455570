"""Changes of tables by key, so that a test does not depend on the text of a file."""

import tomllib
from pathlib import Path
from typing import Any

import tomli_w


def change_keys(content: Any, changes: dict[str, Any]) -> None:
    """Set values of a table by dotted key such as `limit.1.lower`; None removes a key. List items count from 0.

    The item after the last one is appended.
    """
    for key, value in changes.items():
        *tables, last = key.split(".")
        table = content
        for name in tables:
            table = table[int(name)] if isinstance(table, list) else table[name]
        place = int(last) if isinstance(table, list) else last
        if value is None:
            del table[place]
        elif isinstance(table, list) and place == len(table):
            table.append(value)
        else:
            table[place] = value


def write_toml(path: Path, content: dict[str, Any]) -> Path:
    """Write a table as a TOML file."""
    path.write_text(tomli_w.dumps(content), encoding="utf-8")
    return path


def edit_toml(path: Path, changes: dict[str, Any]) -> Path:
    """Change values of a TOML file by dotted key, as in `change_keys`."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    change_keys(content, changes)
    return write_toml(path, content)
