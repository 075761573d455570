"""Walk over the fields of results: each is changed in every way of its type, and `verify` must find the change.

    python -m verification.attacks.field_walk RESULTS.json [--places 3] [--only WORD]

A field is a place in the types of the results, `cases[].criteria[].value`. Each change is tried twice: alone, and
followed by a regrade, after which verdicts, margins and remarks follow from the changed number. A field that needs more
than the document stands in `walked_fields.toml`, with the reason and the means that finds it. The exit code is 1 if
another one is accepted. tests/verification/test_field_walk.py holds the list.
"""

import argparse
import random
import sys
import tomllib
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.documents.document_reading import ResultsFile
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.documents.verification import verify_certificate
from pantocheck.conformance.results.results_format import Results
from verification.attacks.consistent_results import Tree, regrade

LISTS = tomllib.loads(Path(__file__).with_name("walked_fields.toml").read_text("utf-8"))
LISTED: dict[str, dict[str, str]] = {field: entry for entry in LISTS["accepted"] for field in entry["fields"]}
"""Entry of each field with a change that `verify --numbers-only` accepts: its reason, and the means that finds it."""

ABSENT: tuple[str, ...] = tuple(field for entry in LISTS["absent"] for field in entry["fields"])
"""Parts that the walked results do not have."""

Path_ = tuple[str | int, ...]


class Place(NamedTuple):
    """One place of a field in the results of a run."""

    field: str
    path: Path_
    value: Any
    kinds: tuple[Any, ...]
    """Types that the field admits."""


class Change(NamedTuple):
    """Change of the value at one place."""

    field: str
    path: Path_
    value: Any


def list_kinds(annotation: Any) -> tuple[Any, ...]:
    """Types of an annotation without `Annotated`, unions taken apart."""
    annotation = getattr(annotation, "__value__", annotation)
    origin = typing.get_origin(annotation)
    if origin is typing.Annotated:
        return list_kinds(typing.get_args(annotation)[0])
    if origin in (typing.Union, types.UnionType):
        return tuple(kind for part in typing.get_args(annotation) for kind in list_kinds(part))
    return (annotation,)


def list_fields(kinds: Sequence[Any], field: str = "") -> Iterator[str]:
    """Names of all fields of types, those of absent parts included."""
    yield from [field] if field else []
    for kind in kinds:
        origin, arguments = typing.get_origin(kind), typing.get_args(kind)
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            for name, part in kind.model_fields.items():
                yield from list_fields(list_kinds(part.annotation), f"{field}.{part.alias or name}".lstrip("."))
        elif origin in (list, tuple):
            yield from list_fields([k for part in arguments if part is not ... for k in list_kinds(part)], f"{field}[]")
        elif origin is dict:
            yield from list_fields(list_kinds(arguments[1]), f"{field}.*")


def list_places(value: Any, kinds: Sequence[Any], field: str = "", path: Path_ = ()) -> Iterator[Place]:
    """Places of all fields in a value of some types."""
    if field:
        yield Place(field, path, value, tuple(kinds))
    if isinstance(value, BaseModel):
        for name, part in type(value).model_fields.items():
            key, below = part.alias or name, list_kinds(part.annotation)
            yield from list_places(getattr(value, name), below, f"{field}.{key}".lstrip("."), (*path, key))
    elif isinstance(value, Mapping):
        below = [k for kind in kinds if typing.get_origin(kind) is dict for k in list_kinds(typing.get_args(kind)[1])]
        for key, item in value.items():
            yield from list_places(item, below, f"{field}.*", (*path, key))
    elif isinstance(value, list | tuple):
        parts = [a for kind in kinds if typing.get_origin(kind) in (list, tuple) for a in typing.get_args(kind)]
        below = [kind for part in dict.fromkeys(parts) if part is not ... for kind in list_kinds(part)]
        for index, item in enumerate(value):
            yield from list_places(item, below, f"{field}[]", (*path, index))


def list_values(place: Place, stored: Any) -> Iterator[Any]:
    """Other values of a place, by its types: `stored` is its value in JSON."""
    kinds, value = place.kinds, place.value
    if type(None) in kinds and value is not None:
        yield None
    yield from (other for kind in kinds if typing.get_origin(kind) is typing.Literal for other in typing.get_args(kind))
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, int | float):
        yield from (value + 1, value - 1, 0, 1, value / 2, value * 1.001)
    elif isinstance(value, str):
        yield from (f"{value} A", "")
    elif value is None:
        yield from (other for kind, other in ((bool, True), (float, 1.0), (int, 1), (str, "A")) if kind in kinds)
    elif isinstance(value, list | tuple):
        yield from (stored[1:], stored[:-1], [], [*stored, *stored[-1:]])
        yield from ([*stored, "A"] for kind in kinds if str in typing.get_args(kind))
    elif isinstance(value, Mapping):
        yield from ({}, {key: stored[key] for key in list(stored)[1:]}, {key: stored[key] for key in list(stored)[:-1]})


def list_changes(results: Results, places: int, seed: int = 1) -> Iterator[Change]:
    """Changes of every field, at some of its places: the first, the last, and others by chance."""
    found: dict[str, list[Place]] = {}
    for place in list_places(results, [Results]):
        found.setdefault(place.field, []).append(place)
    tree, chance = results.to_dict(), random.Random(seed)
    for field, every in found.items():
        middle = every[1:-1]
        chosen = [every[0], *every[-1:], *chance.sample(middle, min(len(middle), max(0, places - 2)))][:places]
        for place in dict.fromkeys(place.path for place in chosen):
            item = next(other for other in chosen if other.path == place)
            stored = read_place(tree, place)
            if stored is None and item.value is not None:  # the file leaves an empty part or a default out
                empty: Any = [] if isinstance(item.value, list | tuple) else {}
                stored = empty if isinstance(item.value, list | tuple | Mapping) else item.value
            for value in list_values(item, stored):
                if value != stored or isinstance(value, bool) != isinstance(stored, bool):
                    yield Change(field, place, value)


def read_place(tree: Any, path: Path_) -> Any:
    """Value at a place; None where the file leaves the key out."""
    for key in path:
        tree = tree[key] if isinstance(tree, list) else (tree or {}).get(key)
    return tree


def apply_change(tree: Any, path: Path_, value: Any) -> Any:
    """Copy of a tree with another value at one place; all other parts are shared."""
    if not path:
        return value
    copy = list(tree) if isinstance(tree, list) else dict(tree or {})
    held = copy[path[0]] if isinstance(copy, list) else copy.get(path[0])  # type: ignore[arg-type]
    copy[path[0]] = apply_change(held, path[1:], value)  # type: ignore[index]
    return copy


def is_accepted(tree: Tree) -> bool:
    """Whether `verify --numbers-only` accepts results; those that the format refuses are not accepted."""
    try:
        results = Results.model_validate(tree)
        if find_discrepancies(results):  # most changes; the complete verification takes twice as long
            return False
        return verify_certificate(ResultsFile("results.json", results.to_json(), results)).consistent
    except (ValidationError, InputError, UnicodeEncodeError):
        return False


def try_change(tree: Tree, change: Change) -> tuple[str, ...]:
    """Ways in which a change is accepted: `alone`, `regraded`; empty: it is always found."""
    changed = apply_change(tree, change.path, change.value)
    accepted = ["alone"] if is_accepted(changed) else []
    try:
        forged = Results.model_validate(changed).to_dict()
        regrade(forged)
        accepted += ["regraded"] if read_place(forged, change.path) == change.value and is_accepted(forged) else []
    except (ValidationError, InputError, ArithmeticError, ValueError, TypeError, KeyError):
        pass
    return tuple(accepted)


def main() -> int:
    """Walk over the fields of a file, and print the accepted changes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path)
    parser.add_argument("--places", type=int, default=3, help="places of each field")
    parser.add_argument("--only", default="", help="part of the names of the fields")
    options = parser.parse_args()
    results = Results.model_validate_json(options.results.read_bytes())
    tree, tried, unlisted = results.to_dict(), 0, 0
    for change in list_changes(results, options.places):
        if options.only not in change.field:
            continue
        tried += 1
        for way in try_change(tree, change):
            listed = LISTED.get(change.field)
            unlisted += listed is None
            means = "NOT LISTED" if listed is None else listed["means"]
            print(f"{way:9s} {change.field} = {str(change.value)[:60]!r}: {means}", flush=True)
    print(f"{tried} changes; accepted, and not listed: {unlisted}")
    return 1 if unlisted else 0


if __name__ == "__main__":
    sys.exit(main())
