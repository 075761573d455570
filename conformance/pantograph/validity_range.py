"""Highest frequency up to which the model of a pantograph file is supported."""

from typing import Literal

from pantocheck.conformance.core.sourced_table import Positive, SourcedTable


class SupportedRange(SourcedTable):
    """Highest frequency that a pantograph model supports; without this table it is not known."""

    supported_to_Hz: Positive
    """Highest supported frequency [Hz]."""
    basis: Literal["measured_response", "missing_mode"]
    """measured_response: comparison with measured responses; missing_mode: first mode that the model leaves out, from
    the stated source.
    """
