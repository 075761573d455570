"""Values of the reference simulator beside those of the system under test, for information."""

from pantocheck.conformance.core.results_part import Number, Owner, ResultsPart


class ReferenceValues(ResultsPart):
    """Run of the reference simulator on the same case. It takes part in no verdict."""

    name: str
    """Name of the reference simulator."""
    version: str
    reason: str | None
    """Reason why there are no values; null: there are."""
    quantities: dict[Owner, dict[str, Number]]
    """As `quantities` of the case."""
    uncertainty: dict[Owner, dict[str, Number]]
    """Half-widths of the 95 % intervals, as in `quantities`."""
    force_20_N: dict[Owner, list[float]]
    """Filtered force at the positions of `traces` of the case, which has the same pantograph."""
