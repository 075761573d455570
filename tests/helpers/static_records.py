"""Static records computed with a model of a line, so that the differences are known."""

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.model import discretise
from pantocheck.model.statics.elasticity import rest_height, static_uplift

LINE_PATH = library_folder() / "mass-drop-line" / "line.toml"
SPACING = 6.0
"""Distance between measured positions [m]."""
FORCE = 100.0
"""Static force of the elasticities [N]."""

Array = NDArray[np.float64]


def read_unequal_line() -> LineFile:
    """Line of six spans of 54 m to 63 m."""
    return read_model(LINE_PATH, LineFile, "line")


def measure_line(element: float = 0.5) -> dict[str, Array]:
    """Positions [m], elasticities [mm/N] and heights [m] every 6 m, from the model of the suite."""
    line = discretise(build_catenary(read_unequal_line()), element)
    position = np.arange(1.5, line.mesh.position[-1], SPACING)
    elasticity = 1e3 * static_uplift(line, position, FORCE) / FORCE
    heights = rest_height(line, position)
    return {"position_m": position, "elasticity_mm_N": elasticity, "contact_wire_height_m": heights}


def write_static_record(folder: Path, table_columns: dict[str, Array], **sidecar: Any) -> Path:
    """Write a table and its sidecar; return the path of the table."""
    rows = (",".join(f"{value:.9g}" for value in row) for row in zip(*table_columns.values(), strict=True))
    (folder / "measured.csv").write_text("\n".join([",".join(table_columns), *rows]) + "\n", encoding="utf-8")
    stated = {"schema": "pantocheck.static/1", "file": "measured.csv", "force_N": [FORCE], **sidecar}
    content = {key: value for key, value in stated.items() if value is not None}
    (folder / "measured.toml").write_text(tomli_w.dumps(content), encoding="utf-8")
    return folder / "measured.csv"
