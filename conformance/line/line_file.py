"""Line file: geometry of a line, and all of its elements."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.core.features import NO_FEATURE
from pantocheck.conformance.core.sourced_table import InputTable, Problems, cross_check, validation_problem
from pantocheck.conformance.line.elements.element_registry import LineElements
from pantocheck.conformance.line.elements.line_layout import LineLayout
from pantocheck.conformance.line.geometry import GeometryTable, build_layout


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
        return build_layout(self.geometry, self.dropper_schedules)

    @cross_check
    def _check_changed_tables(self) -> Problems:
        for i, support in enumerate(self.geometry.own_supports.values(), 1):
            for key in support.changes:
                if getattr(self, key) is None:
                    yield validation_problem(
                        f"geometry.support[{i}].{key}",
                        f"the line has no table {key}",
                        f"Give [{key}] for the whole line; a support changes its values.",
                    )
