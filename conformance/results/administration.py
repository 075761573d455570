"""Administrative data of a report: persons, organisation and number. They change no value and no verdict."""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.core.texts import find_unshowable
from pantocheck.conformance.core.toml_file import read_model

NamedText = Annotated[str | None, Field(min_length=1, max_length=200)]
RemarkText = Annotated[str | None, Field(min_length=1, max_length=2000)]


class Administration(InputTable):
    """Administrative data, in a file of a user, in a plan and in results.json; at least one key is given."""

    report_number: NamedText = None
    """Number or reference of the report."""
    issuer: NamedText = None
    """Person who issues the report."""
    organisation: NamedText = None
    """Organisation of the issuer."""
    contact: NamedText = None
    """Address of the issuer for questions."""
    assessor: NamedText = None
    """Person or body that assesses the report."""
    remarks: RemarkText = None
    """Remarks for the reader; pages show line breaks as spaces."""

    @cross_check
    def _has_content(self) -> Problems:
        keys = list(type(self).model_fields)
        if all(getattr(self, key) is None for key in keys):
            yield validation_problem(keys[0], "no key is given", f"Give at least one of {', '.join(keys)}.")

    @cross_check
    def _can_be_printed(self) -> Problems:
        for key in type(self).model_fields:
            text = getattr(self, key) or ""
            found = find_unshowable(text.replace("\n", " ") if key == "remarks" else text)
            if found is not None:
                name = f"the character U+{ord(found):04X}"
                yield validation_problem(key, f"found {name}", "Leave it out: pages cannot show it on one line.")


def read_administration(path: Path) -> Administration:
    """Read a file of administrative data.

    Raises:
        InputError: The file cannot be read or is wrong.
    """
    return read_model(path, Administration, "administration")
