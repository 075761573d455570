"""Origin of a case from outside the library, in results.json."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_origin import OriginKind
from pantocheck.conformance.results.results_part import ResultsPart


class OriginFacts(ResultsPart):
    """File, folder or installed distribution that holds the case file."""

    kind: OriginKind
    name: str
    version: Annotated[str, Field(description="version of the distribution; empty for a file or folder")]
    digest: Annotated[
        str, Field(description="SHA-256 of the case file, or of all TOML files of the folder or distribution")
    ]

    @property
    def text(self) -> str:
        """Origin in messages, such as `distribution acme-lines 1.0`."""
        return f"{self.kind} {self.name} {self.version}".strip()


def describe_case_origin(case: Case) -> OriginFacts | None:
    """Origin of a case; None for a case of the library."""
    if (origin := case.origin) is None:
        return None
    return OriginFacts(kind=origin.kind, name=origin.name, version=origin.version, digest=origin.digest)
