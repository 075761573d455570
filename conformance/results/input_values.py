"""Values of the inputs of a case in results.json: every key of a table, lists of tables column by column."""

from pantocheck.conformance.input_files.sourced_table import PROVENANCE, SourcedTable
from pantocheck.conformance.results.case_facts_format import StoredRange, StoredValue

NAME_KEYS = frozenset({"id", "title", "line", "model", "requires", "edition", "superseded_by", "on_request"})
"""Keys that name a case or its files, and are no inputs."""

OTHER_PARTS = frozenset({"limit", "pantograph", "mass_drop", "study", "damping"})
"""Keys of a case file with groups of their own."""

MOST_LISTED = 12
"""Longest list whose values are all stored; of a longer one, number and range are: a line may have 500 spans."""


def list_input_values(table: SourcedTable, groups: set[str], group: str) -> dict[str, StoredValue]:
    """Values that the file of a table states.

    Args:
        table: Table of a case, line or pantograph.
        groups: Names of all groups of inputs; a part of the table that is a group of its own is left out.
        group: Name of the group of the table.
    """
    excluded = {key for key in type(table).model_fields if f"{group}.{key}" in groups}
    excluded |= PROVENANCE | NAME_KEYS | (OTHER_PARTS if group == "case" else frozenset())
    tree = table.model_dump(mode="json", exclude=excluded, exclude_unset=True, exclude_none=True)
    columns: dict[str, list[object]] = {}
    for key, value in tree.items():
        _collect(key, value, columns)
    return {key: _summarise(values) for key, values in columns.items() if values}


def _collect(key: str, value: object, columns: dict[str, list[object]]) -> None:
    """Collect the values of nested tables and lists by their dotted key."""
    if isinstance(value, dict):
        for name, part in value.items():
            if name not in PROVENANCE:
                _collect(f"{key}.{name}", part, columns)
    elif isinstance(value, list):
        for part in value:
            _collect(key, part, columns)
    elif value is not None:
        columns.setdefault(key, []).append(value)


def _summarise(values: list[object]) -> StoredValue:
    """One value as it is, a short list as a list, a long one as number and range, or as its different texts."""
    numbers = [float(value) for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(values) == 1:
        [value] = values
        return value if isinstance(value, bool | str) else numbers[0]
    if len(numbers) == len(values) > MOST_LISTED:
        return StoredRange(count=len(numbers), lowest=min(numbers), highest=max(numbers))
    if len(numbers) == len(values):
        return list(numbers)
    texts = [
        value if isinstance(value, float | int) and not isinstance(value, bool) else str(value) for value in values
    ]
    return texts if len(texts) <= MOST_LISTED else list(dict.fromkeys(texts))[:MOST_LISTED]
