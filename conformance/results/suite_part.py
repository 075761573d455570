"""Suite in the files that it writes."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.results.results_part import ResultsPart


class Suite(ResultsPart):
    """Suite that graded the system."""

    version: str
    commit: str | None
    digest: Annotated[str, Field(description="SHA-256 of the installed files of the suite")]
