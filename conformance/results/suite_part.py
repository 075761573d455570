"""Suite in the files that it writes."""

from pantocheck.conformance.results.results_part import ResultsPart


class Suite(ResultsPart):
    """Suite that graded the system."""

    version: str
    commit: str | None
    digest: str
    """SHA-256 of the installed files of the suite."""
