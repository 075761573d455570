"""Kind of an input file, recognised by its keys."""

import typing
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.schemas import READ_FORMATS, WRITTEN_FORMATS


def recognise_toml(tree: Mapping[str, Any], where: str) -> str:
    """Recognise the kind of a TOML file: the format with the fewest unknown and missing keys.

    Args:
        tree: Content of the file.
        where: Name of the file in messages.

    Returns:
        Name of the format, a key of `READ_FORMATS`.

    Raises:
        InputError: No format has a key of the file, or several formats fit equally well.
    """
    ranks = {kind: rank for kind, model in READ_FORMATS.items() if (rank := _rank(model, tree)) is not None}
    best = [kind for kind, rank in ranks.items() if rank == min(ranks.values())]
    if len(best) == 1:
        return best[0]
    found = f"may be of the kind {' or '.join(best)}" if best else "has no key of any kind of input file"
    raise InputError(where, found, f"Give the option --kind with one of {', '.join(READ_FORMATS)}.")


def recognise_json(content: Any, where: str) -> str:
    """Recognise the kind of a JSON file by its schema; a list contains modes. Parameters as in `recognise_toml`."""
    if isinstance(content, list):
        return "modes"
    stated = content.get("schema") if isinstance(content, dict) else None
    known = {name: kind for kind, model in WRITTEN_FORMATS.items() for name in _list_schemas(model) if name}
    if not isinstance(stated, str) or stated not in known:
        found = "no schema is stated" if stated is None else f"found {str(stated)[:60]!r}"
        raise InputError(f"{where}, key schema", found, f"Known are {', '.join(known)}.")
    return known[stated]


def list_keys(model: type[BaseModel]) -> set[str]:
    """Keys of a table."""
    return {field.alias or name for name, field in model.model_fields.items()}


def _rank(model: type[BaseModel], tree: Mapping[str, Any]) -> tuple[bool, int, int] | None:
    """Other schema, number of unknown keys and number of missing keys; None if no key is known."""
    known = list_keys(model)
    if not known & tree.keys():
        return None
    required = {field.alias or name for name, field in model.model_fields.items() if field.is_required()}
    return tree.get("schema") not in _list_schemas(model), len(tree.keys() - known), len(required - tree.keys())


def _list_schemas(model: type[BaseModel]) -> tuple[Any, ...]:
    """Values of the key `schema`; None if the format has no such key."""
    field = model.model_fields.get("schema_")
    return (None,) if field is None else typing.get_args(field.annotation)
