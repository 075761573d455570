"""Warning of a report in Python that is written without PDF."""

import warnings
from collections.abc import Sequence

from pantocheck.conformance.reports.formats.report_writers import remark_missing_formats


def warn_missing_formats(stated: Sequence[str] | None = None) -> None:
    """Warn the caller of a method of the interface of default formats whose extra is not installed.

    Args:
        stated: Formats that the caller states; None: the default formats.
    """
    for remark in remark_missing_formats(stated):
        warnings.warn(remark, stacklevel=3)
