"""Events of a record in results.json."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.results.results_part import ResultsPart


class EventFacts(ResultsPart):
    """Stretch of the line inside the analysis section; positions [m] in running direction."""

    kind: str
    name: str
    start_m: float
    end_m: float
    excluded: Annotated[bool, Field(description="whether the statistics of the contact force leave it out")]
    remark: Annotated[str, Field(description="stated reason of the exclusion, or why it is not applied")] = ""
