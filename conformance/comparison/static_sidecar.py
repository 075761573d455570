"""Sidecar of a static record: the TOML file beside a table of static values measured along a line."""

from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, Positive, PositiveList, validation_problem
from pantocheck.conformance.records.sidecar_tables import TableDigest, TableName, find_table_name_problems

STATIC_SCHEMA = "pantocheck.static/1"


class StaticSidecar(InputTable):
    """Sidecar of a table of contact wire heights and elasticities."""

    schema_: Annotated[
        Literal["pantocheck.static/1"],
        Field(alias="schema", description='version of the format: "pantocheck.static/1"'),
    ]
    file: TableName
    sha256: TableDigest = None
    force_N: Annotated[
        PositiveList | None,
        Field(
            max_length=2,
            description="static force of the elasticity [N]: one force, for the uplift from rest over the force; or "
            "two, for the difference of the uplifts over the difference of the forces",
        ),
    ] = None
    line_start_m: Annotated[
        float, Field(ge=-1e7, le=1e7, description="position of the start of the line, as the table counts [m]")
    ] = 0.0
    positions: Annotated[
        Literal["increasing", "decreasing"],
        Field(description="direction in which the table counts positions, from the start of the line to its end"),
    ] = "increasing"
    datum_m: Annotated[
        float, Field(ge=-100, le=100, description="height of the datum of the line, as the table counts [m]")
    ] = 0.0
    evaluated_spans: Annotated[
        tuple[int, int] | None,
        Field(strict=False, description="first and last span of the evaluated section, from 1; default: all spans"),
    ] = None
    largest_distance_m: Annotated[
        Positive | None,
        Field(description="largest distance between neighbouring measured positions of a complete record [m]"),
    ] = None
    elasticity_uncertainty_mm_N: Annotated[
        Positive | None, Field(description="half-width of the 95 % interval of a measured elasticity [mm/N]")
    ] = None
    height_uncertainty_mm: Annotated[
        Positive | None, Field(description="half-width of the 95 % interval of a measured contact wire height [mm]")
    ] = None
    note: Annotated[str | None, Field(description="remark for the reader", max_length=4000)] = None

    @cross_check
    def _check_consistency(self) -> Problems:
        yield from find_table_name_problems(self.file)
        if self.force_N is not None and len(self.force_N) == 2 and self.force_N[0] >= self.force_N[1]:
            yield validation_problem(
                "force_N", "the second force is not greater than the first", "Give the smaller force first."
            )
        if self.evaluated_spans is not None and not 1 <= self.evaluated_spans[0] <= self.evaluated_spans[1]:
            yield validation_problem(
                "evaluated_spans",
                f"{list(self.evaluated_spans)} are not a first and a last span",
                "Give the first and the last span, numbered from 1, e.g. [2, 9].",
            )
