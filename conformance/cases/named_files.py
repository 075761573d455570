"""Recognition of a line or a pantograph in the place of a case."""

from collections.abc import Collection

from pydantic import BaseModel

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile

FORMATS: dict[str, type[BaseModel]] = {"line": LineFile, "pantograph": PantographFile}
"""Files that a case names."""


def recognise_named_file(keys: Collection[str]) -> str | None:
    """Kind of a file that a case names, a key of `FORMATS`; None for a case and for unknown keys.

    Args:
        keys: Keys of the file. A case is recognised by `id` or `line`.
    """
    if {"id", "line"} & {*keys}:
        return None
    shares = {
        kind: len(({*model.model_fields} - {*CaseFile.model_fields}) & {*keys}) for kind, model in FORMATS.items()
    }
    best = max(shares, key=lambda kind: shares[kind])
    return best if shares[best] else None
