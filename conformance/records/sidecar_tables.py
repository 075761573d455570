"""Common tables and keys of sidecars and summaries: table, system, run and line."""

from pathlib import PureWindowsPath
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems
from pantocheck.conformance.input_files.sourced_table import InputTable, NonNegative, validation_problem

Speed = Annotated[float, Field(ge=1, le=600, description="speed of the train [km/h]")]

TableName = Annotated[str, Field(min_length=1, max_length=500, description="name of the table beside the sidecar")]

TableDigest = Annotated[
    str | None, Field(pattern="^[0-9a-f]{64}$", description="SHA-256 of the table, to detect a damaged copy")
]

CaseName = Annotated[str | None, Field(max_length=200, description="id of the case that was run")]

CaseDigest = Annotated[
    str,
    Field(
        pattern="^sha256:[0-9a-f]{64}$",
        description="digest of the inputs of this case, equal to input_digest in the results of the case",
    ),
]


class SystemTable(InputTable):
    """Simulator or measuring system of a record."""

    name: Annotated[str, Field(max_length=200)]
    """Name of the simulator or measuring system."""
    version: Annotated[str, Field(max_length=200)] = ""
    """Version of the simulator or measuring system."""


class RunTable(InputTable):
    """Data of a simulation; all keys are optional."""

    simulated_s: Annotated[float | None, Field(gt=0)] = None
    """Simulated time [s]."""
    wall_s: Annotated[float | None, Field(ge=0)] = None
    """Computing time [s]."""
    dt_s: Annotated[float | None, Field(gt=0)] = None
    """Time step [s]."""
    element_m: Annotated[float | None, Field(gt=0)] = None
    """Element length [m]."""


StartCondition = Literal["equilibrium_under_uplift_forces", "line_at_rest", "other"]
"""State of line and pantographs at the start of a run.

`equilibrium_under_uplift_forces`: static equilibrium with every pantograph pressing with its uplift force;
`line_at_rest`: the line carries its weight only, the contact forces begin at zero.
"""


class StartTable(InputTable):
    """Start of a simulation."""

    place_m: float
    """Position of the last pantograph at the start of the run [m]."""
    ramp_m: NonNegative = 0.0
    """Distance over which speed or force reaches its full value [m]; 0: full from the start."""
    state: StartCondition
    """State of line and pantographs; equilibrium_under_uplift_forces: static equilibrium with every pantograph
    pressing with its uplift force; line_at_rest: contact forces begin at zero.
    """


class LineTable(InputTable):
    """Data of the line for the rules of a profile; all keys are optional."""

    span_m: Annotated[float | None, Field(ge=5, le=200)] = None
    """Length of the longest span [m]."""
    wave_speed_m_s: Annotated[float | None, Field(gt=0, le=1000)] = None
    """Speed of transverse waves on the contact wire [m/s]."""
    uplift_space_mm: Annotated[NonNegative | None, Field(le=2000)] = None
    """Space for the uplift of the contact wire at the supports [mm]."""


def find_table_name_problems(name: str) -> Problems:
    """Problem of the name of a table that is a path."""
    # On Windows, `C:table.csv` is a path, too; the same record must be valid on all systems.
    if "/" in name or "\\" in name or name in {".", ".."} or "\0" in name or PureWindowsPath(name).drive:
        yield validation_problem(
            "file", f"found the path {name!r}", "Put the table beside its sidecar, and give its name only."
        )


def find_section_problems(section: tuple[float, ...] | None) -> Problems:
    """Problem of an analysis section [m] whose end is not behind its start."""
    if section is not None and section[0] >= section[1]:
        yield validation_problem(
            "evaluated_m", "the end is not greater than the start", "Give the start, then the end of the section."
        )
