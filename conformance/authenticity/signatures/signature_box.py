"""Places of visible signatures: boxes in the top margin of page 1, where a report prints nothing."""

from typing import Any

BOXES = {
    "top-left": (51, 812, 209, 834),
    "top-centre": (218, 812, 376, 834),
    "top-right": (386, 812, 544, 834),
}
"""Left, bottom, right and top edge of each box [points from the lower left corner of an A4 page]."""

INVISIBLE = "invisible"
"""Place of a signature without a box."""


def find_place(field: Any) -> str:
    """Place of the box of a signature field of a PDF; empty for any other place.

    Args:
        field: Field and widget in one (reference to a dictionary of pyHanko).

    Returns:
        A key of `BOXES`, `INVISIBLE` for a box without an area, or nothing.
    """
    rectangle = [float(edge) for edge in field.get_object()["/Rect"]]
    left, bottom, right, top = rectangle
    if left == right and bottom == top:
        return INVISIBLE
    return next((name for name, box in BOXES.items() if rectangle == [float(edge) for edge in box]), "")
