"""Finding of a publication, graded by a limit."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import InputTable

Role = Literal["imposed", "held_out"]
"""`imposed`: the inputs of the case were chosen with the finding; `held_out`: they were chosen without it."""


class PublishedFinding(InputTable):
    """Finding of a publication: its sentence, its role, and the choices behind the bounds of its limit."""

    section: Annotated[str, Field(max_length=40)]
    """Section, table or figure of the publication."""
    sentence: Annotated[str, Field(max_length=500)]
    """Statement of the publication in one sentence."""
    role: Role
    """imposed: the search for the inputs used the finding; held_out: it did not."""
    printed: Annotated[str, Field(max_length=100)] = "none"
    """Number in the publication; none: it states no number."""
    tolerance: Annotated[str, Field(max_length=500)]
    """Origin of the bounds and of their tolerance."""
    sensitivity: Annotated[str, Field(max_length=1000)] = ""
    """Reason, with numbers, why the case does not reproduce the finding."""
