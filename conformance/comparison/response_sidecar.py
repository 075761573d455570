"""Sidecar of a response record: the TOML file beside a table of a frequency response measured at a pantograph head."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.comparison.response_kinds import ResponseKind
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import (
    NO_SOURCE,
    InputTable,
    NonNegative,
    Positive,
    validation_problem,
)
from pantocheck.conformance.records.sidecar_tables import TableDigest, TableName, find_table_name_problems

RESPONSE_SCHEMA = "pantocheck.response/1"

HeadPoint = Literal["head_centre", "left_strip", "right_strip", "other"]
"""Point of the head: its centre, one of its contact strips, or another one."""

ResponseColumn = Annotated[str, Field(min_length=1, max_length=200)]


class ResponseSidecar(InputTable):
    """Sidecar of a table of frequency, modulus and phase."""

    schema_: Annotated[
        Literal["pantocheck.response/1"],
        Field(alias="schema", description='version of the format: "pantocheck.response/1"'),
    ]
    file: TableName
    sha256: TableDigest = None
    kind: Annotated[
        ResponseKind,
        Field(
            description="measured quantity; force over motion: apparent_mass, impedance, dynamic_stiffness; motion "
            "over force: accelerance, mobility, receptance"
        ),
    ]
    rows: Annotated[
        int, Field(ge=1, le=100_000, description="number of rows of the complete table, so that a lost row is noticed")
    ]
    static_force_N: Annotated[
        NonNegative, Field(le=2000, description="static force on the head during the measurement [N]")
    ]
    height_m: Annotated[
        float | None, Field(ge=-10, le=20, description="height of the head during the measurement, any datum [m]")
    ] = None
    excited_at: Annotated[HeadPoint, Field(description="point of the force; strips are shown, not graded")] = (
        "head_centre"
    )
    measured_at: Annotated[HeadPoint, Field(description="point of the motion; strips are shown, not graded")] = (
        "head_centre"
    )
    force_and_motion: Annotated[
        Literal["same_direction", "opposite_directions"],
        Field(description="directions in which force and motion count as positive"),
    ] = "same_direction"
    scale: Annotated[
        Positive, Field(le=1e12, description="factor from the table to the unit in the name of its columns")
    ] = 1.0
    columns: Annotated[
        dict[str, ResponseColumn],
        Field(
            default_factory=dict,
            max_length=10,
            description="names of the columns in the table, where they are others: the name of this suite, with its "
            "unit, then that of the table; further columns are ignored then",
        ),
    ]
    modulus_uncertainty_pct: Annotated[
        Positive | None, Field(le=100, description="half-width of the 95 % interval of the modulus [%]")
    ] = None
    phase_uncertainty_deg: Annotated[
        Positive | None, Field(le=180, description="half-width of the 95 % interval of the phase [degrees]")
    ] = None
    source: Annotated[str, Field(min_length=1, max_length=500, description="test report, test rig and date")] = (
        NO_SOURCE
    )
    note: Annotated[str | None, Field(description="remark for the reader", max_length=4000)] = None

    @cross_check
    def _check_file(self) -> Problems:
        yield from find_table_name_problems(self.file)

    @cross_check
    def _check_uncertainty(self) -> Problems:
        stated = {"modulus_uncertainty_pct": self.modulus_uncertainty_pct}
        stated |= {"phase_uncertainty_deg": self.phase_uncertainty_deg}
        missing = [key for key, value in stated.items() if value is None]
        if len(missing) == 1:
            yield validation_problem(missing[0], "missing, although the other uncertainty is given", "Give both.")

    @property
    def is_at_head(self) -> bool:
        """Whether force and motion belong to the centre of the head, the one point of the models."""
        return self.excited_at == self.measured_at == "head_centre"
