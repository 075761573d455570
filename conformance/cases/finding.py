"""Finding of a publication, graded by a limit."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import InputTable

Role = Literal["imposed", "held_out"]
"""`imposed`: the inputs of the case were chosen with the finding; `held_out`: they were chosen without it."""


class PublishedFinding(InputTable):
    """Finding of a publication: its sentence, its role, and the choices behind the bounds of its limit."""

    section: Annotated[str, Field(max_length=40, description="section, table or figure of the publication")]
    sentence: Annotated[str, Field(max_length=500, description="statement of the publication in one sentence")]
    role: Annotated[
        Role,
        Field(description="imposed: the search for the inputs used the finding; held_out: it did not"),
    ]
    printed: Annotated[
        str, Field(max_length=100, description="number in the publication; none: it states no number")
    ] = "none"
    tolerance: Annotated[str, Field(max_length=500, description="origin of the bounds and of their tolerance")]
    sensitivity: Annotated[
        str, Field(max_length=1000, description="reason, with numbers, why the case does not reproduce the finding")
    ] = ""
