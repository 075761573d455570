"""Tables that sidecars and summary records share: origin, computation and line."""

from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.sourced_table import InputTable, NonNegative, validation_problem

Speed = Annotated[float, Field(ge=1, le=600, description="speed of the train [km/h]")]

CaseDigest = Annotated[
    str,
    Field(
        pattern="^sha256:[0-9a-f]{64}$",
        description="digest of the inputs of the case that was run, as its results state it (input_digest)",
    ),
]


class SystemTable(InputTable):
    """Origin of a record: a simulator or a measuring system."""

    name: Annotated[str, Field(max_length=200, description="name of the simulator or measuring system")]
    version: Annotated[str, Field(max_length=200, description="version of the simulator or measuring system")] = ""


class RunTable(InputTable):
    """Computation of a simulated record; every key is optional."""

    simulated_s: Annotated[float | None, Field(gt=0, description="simulated time [s]")] = None
    wall_s: Annotated[float | None, Field(ge=0, description="computing time [s]")] = None
    dt_s: Annotated[float | None, Field(gt=0, description="time step [s]")] = None
    element_m: Annotated[float | None, Field(gt=0, description="length of an element [m]")] = None


class LineTable(InputTable):
    """Data of the line that the rules of a profile need; every key is optional."""

    span_m: Annotated[
        float | None, Field(ge=5, le=200, description="length of a span, the period of the contact force [m]")
    ] = None
    wave_speed_m_s: Annotated[
        float | None, Field(gt=0, le=1000, description="speed of transverse waves on the contact wire [m/s]")
    ] = None
    uplift_space_mm: Annotated[
        NonNegative | None, Field(le=2000, description="free space for uplift at the supports [mm]")
    ] = None


def check_section(section: tuple[float, ...] | None) -> None:
    """Refuse an analysis section [m] that ends before it begins; for validators."""
    if section is not None and section[0] >= section[1]:
        raise validation_problem(
            "evaluated_m", "the analysis section ends before it begins", "Give its start, then its end."
        )
