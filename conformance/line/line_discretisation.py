"""Discretised line of a line file; cases on one line share it, with everything that does not depend on the train."""

from dataclasses import dataclass, field
from functools import lru_cache

from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import DiscretisedLine, discretise

KEPT_LINES = 4
"""Lines kept in memory: one line on the three meshes of a case, and its shortened copy for the natural frequencies."""


@dataclass(frozen=True)
class _Content:
    """Line file that equals another one with the same content."""

    text: str
    line: LineFile = field(compare=False)


def discretise_line(line: LineFile, element: float) -> DiscretisedLine:
    """Discretise a line; the last lines are kept.

    Args:
        line: Content of the line file.
        element: Largest length of an element [m].

    Returns:
        Line at rest.

    Raises:
        NoInitialState: The prescribed geometry has no equilibrium.
    """
    return _discretise(_Content(line.model_dump_json(), line), element)


@lru_cache(KEPT_LINES)
def _discretise(content: _Content, element: float) -> DiscretisedLine:
    return discretise(build_catenary(content.line), element)
