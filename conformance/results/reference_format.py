"""Values of the reference simulator beside those of the system under test, for information."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.results.results_part import Number, Owner, ResultsPart


class ReferenceValues(ResultsPart):
    """Run of the reference simulator on the same case. It takes part in no verdict."""

    name: Annotated[str, Field(description="name of the reference simulator")]
    version: str
    reason: Annotated[str | None, Field(description="reason why there are no values; null: there are")]
    quantities: Annotated[dict[Owner, dict[str, Number]], Field(description="as `quantities` of the case")]
    uncertainty: Annotated[
        dict[Owner, dict[str, Number]], Field(description="half-widths of the 95 % intervals, as in `quantities`")
    ]
    force_20_N: Annotated[
        dict[Owner, list[float]],
        Field(description="filtered force at the positions of `traces` of the case, which has the same pantograph"),
    ]
