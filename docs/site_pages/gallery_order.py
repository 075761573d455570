"""Order of the examples in the gallery: line and train, several runs, measurements."""

from os import PathLike
from pathlib import Path

ORDER = (
    *(
        "own_line",
        "speed_sweep",
        "two_pantographs",
        "elasticity_and_uplift",
        "stitch_wire",
        "overlap",
        "irregular_wire",
    ),
    *("catenary_in_python", "waves_and_doppler"),
    *("foreign_simulator", "line_test", "uncertainty", "tolerance_study", "certificate"),
    *("pantograph_response", "drop_and_identification", "damping_fit", "damping_study"),
)
"""Names of the examples; others follow by name."""


class GalleryOrder:
    """Sort key of the examples, as sphinx-gallery needs it.

    Args:
        folder: Folder of the examples; the order does not depend on it.
    """

    def __init__(self, folder: str | PathLike[str]) -> None:
        self.folder = folder

    def __call__(self, file: str | PathLike[str]) -> tuple[int, str]:
        """Place of an example by the name of its file."""
        name = Path(file).stem
        return ORDER.index(name) if name in ORDER else len(ORDER), name

    def __repr__(self) -> str:
        """Text without an address, so that Sphinx sees no changed configuration."""
        return f"{type(self).__name__}()"
