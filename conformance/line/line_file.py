"""Line file: geometry of a line, and all of its elements."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE
from pantocheck.conformance.core.sourced_table import InputTable
from pantocheck.conformance.line.elements.element_registry import LineElements
from pantocheck.conformance.line.geometry import GeometryTable
from pantocheck.conformance.line.line_layout import LineLayout, build_layout


class LineHead(InputTable):
    """First keys of a line file."""

    title: Annotated[str, Field(max_length=200)]
    """Title in reports."""
    geometry: GeometryTable


class LineFile(LineElements, LineHead):
    """Content of a line file."""

    note: Annotated[str | None, Field(max_length=4000), NO_FEATURE] = None
    """Remark for the reader."""

    @property
    def layout(self) -> LineLayout:
        """Spans and supports with all their values, in either form of the geometry."""
        return build_layout(self.geometry, self.dropper_schedules, self.steady_arm, self.messenger_support)
