"""Features of a case: the keys of line and pantograph files that use them, and those of the run."""

from collections.abc import Iterator
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from pantocheck.conformance.core.features import find_declaration
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from site_pages.markdown_table import build_markdown_table

RUN_USES = {
    "applied_forces": "static and aerodynamic force at different points",
    "line_at_rest": "no train: a check of the line at rest",
    "mass_drop": "mass drops in place of a train",
    "several_pantographs": "two or more pantographs",
    "uplift_force_tuning": "an uplift force that is tuned to a mean contact force",
}
"""Use of each feature of a run."""

MOST_KEYS = 4
"""Largest number of keys that a row names."""


def build_feature_table() -> str:
    """Every feature, with the keys of the files that use it."""
    keys: dict[str, list[str]] = {}
    for path, field in list_file_keys():
        feature = find_declaration(field)
        if feature and feature.name and path not in keys.setdefault(feature.name, []):
            keys[feature.name].append(path)
    rows = {name: _name_keys(paths) for name, paths in keys.items()} | RUN_USES
    return build_markdown_table(("feature", "used by"), [(f"`{name}`", rows[name]) for name in sorted(rows)]) + "\n"


def _name_keys(paths: list[str]) -> str:
    """Keys without those of a table that is named itself."""
    highest = [path for path in paths if not any(path.startswith(f"{other}.") for other in paths)]
    more = f" and {len(highest) - MOST_KEYS} more" if len(highest) > MOST_KEYS else ""
    return ", ".join(f"`{path}`" for path in highest[:MOST_KEYS]) + more


def list_file_keys() -> Iterator[tuple[str, FieldInfo]]:
    """Keys with a default of line and pantograph files."""
    yield from list_optional_keys(LineFile, "line")
    yield from list_optional_keys(PantographFile, "pantograph")


def list_optional_keys(table: type[BaseModel], path: str) -> Iterator[tuple[str, FieldInfo]]:
    """Keys with a default of a table and of the tables inside."""
    for name, field in table.model_fields.items():
        if name in PROVENANCE or name == "force_law":
            continue
        if not field.is_required() and not isinstance(field.default, BaseModel):
            yield f"{path}.{name}", field
        for model in find_models(field.annotation):
            yield from list_optional_keys(model, f"{path}.{name}")


def find_models(annotation: Any) -> Iterator[type[BaseModel]]:
    """Models inside the type of a key."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif get_origin(annotation) in (Union, UnionType, Annotated, tuple, dict):
        for argument in get_args(annotation):
            yield from find_models(argument)
