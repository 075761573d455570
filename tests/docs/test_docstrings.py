"""Docstrings of the public interface: valid for numpydoc, from which the reference is made."""

import inspect
from collections.abc import Iterator

import pytest

import pantocheck.conformance
import pantocheck.model

validation = pytest.importorskip("numpydoc.validate", reason="the extra docs is not installed")

CHECKS = {
    "GL03", "GL06", "GL07", "GL08",  # blank lines, unknown sections, their order, a docstring
    "SS01", "SS02", "SS03", "SS04",  # a summary: capital letter, full stop, no indentation
    "PR01", "PR02", "PR03", "PR04", "PR05", "PR06", "PR07", "PR08", "PR09", "PR10",  # every parameter with its type
    "RT02", "RT03", "RT04", "RT05", "YD01",  # returned values, where a section describes them
}  # fmt: skip
"""Not RT01: the summary of a formula or a method names its value with the unit, and the annotation states its type.
Not EX01, SA01, ES01: examples are in the pages, related names on one page, and a summary may be all there is to say."""


def list_public_names() -> Iterator[str]:
    """Import paths of the public functions and classes, and of the public methods of the latter."""
    for module in (pantocheck.conformance, pantocheck.model):
        for name in module.__all__:
            item = getattr(module, name)
            if not (inspect.isfunction(item) or inspect.isclass(item)) or name == "Kind":
                continue  # an enumeration has the parameters of `enum.Enum`
            path = f"{item.__module__}.{item.__qualname__}"
            yield path
            parts = vars(item).items() if inspect.isclass(item) else ()
            yield from (
                f"{path}.{key}"
                for key, part in parts
                if not key.startswith("_") and (inspect.isfunction(part) or isinstance(part, property))
            )


def test_docstrings_are_valid() -> None:
    found = {name: validation.validate(name)["errors"] for name in sorted(list_public_names())}
    assert [(name, code, text) for name, errors in found.items() for code, text in errors if code in CHECKS] == []
