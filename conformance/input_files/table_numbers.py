"""Numbers of tables in messages: a table of a list that states its number is found by it, not by its place."""

import re
from typing import Any

_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def append_table_number(key: str, tree: Any) -> str:
    """Append the number of the innermost table of a list that states one.

    Args:
        key: Dotted key with the items of lists numbered from 1, e.g. `geometry.support[2].encumbrance_m`.
        tree: Content of the file.

    Returns:
        The key, e.g. `geometry.support[2].encumbrance_m (number 7)`; unchanged without such a table, and for the number
        itself.
    """
    number: object = None
    for step in _STEP.finditer(key):
        name, item = step.groups()
        if item is None:
            tree = tree.get(name) if isinstance(tree, dict) else None
        else:
            tree = tree[int(item) - 1] if isinstance(tree, list) and 0 < int(item) <= len(tree) else None
            stated = tree.get("number") if isinstance(tree, dict) else None
            number = stated if isinstance(stated, int) else number
    return key if number is None or key.endswith(".number") else f"{key} (number {number})"
