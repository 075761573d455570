"""Content of the files of a case with inputs that were changed on the command line."""

import copy
import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.input_changes import InputChange
from pantocheck.conformance.counted_noun import count_noun
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.key_paths import find_holders, follow_path
from pantocheck.conformance.input_files.sourced_table import SourcedTable


def change_case(tree: dict[str, Any], changes: Sequence[InputChange]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Apply changes to the content of a case file; returns and errors as in `change_tree`."""
    uses = tree.get("pantograph")
    count = len(uses) if isinstance(uses, list) else 0
    assigned: list[InputChange] = []
    for change in changes:
        if change.part == "case":
            assigned.append(change)
        elif change.part != "line" and (count == 0 or (change.pantograph or 0) >= count):
            hint = "Pantographs are numbered from 1 in running order."
            raise InputError(change.where, f"the case has {count_noun(count, 'pantograph')}", hint)
        elif change.part == "use":
            numbers = range(count) if change.pantograph is None else (change.pantograph,)
            assigned += [replace(change, part="case", path=("pantograph", i, *change.path)) for i in numbers]
    return change_tree(tree, CaseFile, assigned)


def change_tree(
    tree: dict[str, Any], model: type[BaseModel], changes: Sequence[InputChange]
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Apply changes to the content of a file.

    Args:
        tree: Content of the file.
        model: Model of the file.
        changes: Changes of this file.

    Returns:
        tree: Changed content. Changed keys count as `provisional`, because the source of their table does not state
            them.
        descriptions: One text per value that differs, with the value of the file.

    Raises:
        InputError: A table or a list item does not exist.
    """
    if not changes:
        return tree, ()
    changed = copy.deepcopy(tree)
    descriptions = []
    for change in changes:
        holder, part, before = follow_path(changed, change.path, change.where)
        if before == change.value and isinstance(before, bool) == isinstance(change.value, bool):
            continue
        holder[part] = change.value
        _mark_provisional(changed, model, change)
        stated = "not in the file" if before is None else f"file: {_show(before)}"
        descriptions.append(f"{change.key} = {_show(change.value)} ({stated})")
    return changed, tuple(dict.fromkeys(descriptions))


def _mark_provisional(tree: dict[str, Any], model: type[BaseModel], change: InputChange) -> None:
    """Add a changed key to the key `provisional` of its sourced table."""
    holders = find_holders(model, change.path)
    sourced = [i for i, table in enumerate(holders) if table is not None and issubclass(table, SourcedTable)]
    if sourced:
        table, key, _ = follow_path(tree, change.path[: sourced[-1] + 1], change.where)
        marked = table.get("provisional", [])
        table["provisional"] = list(dict.fromkeys([*marked, key])) if isinstance(marked, list) else marked


def _show(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 200 else text[:197] + "..."
