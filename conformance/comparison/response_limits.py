"""Limits of a response comparison: a TOML file of the user, which names every load level that must agree."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from pantocheck.conformance.comparison.response_deviation import RESPONSE_BANDS, ResponseQuantity
from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import (
    NO_SOURCE,
    InputTable,
    NonNegativeList,
    NumberList,
    Positive,
    validation_problem,
)
from pantocheck.conformance.input_files.toml_file import read_model


class ResponseLimit(InputTable):
    """Upper bound of the deviation in one band, for responses at the centre of the head."""

    quantity: Annotated[
        ResponseQuantity,
        Field(
            description="RMS deviation over the band of modulus, phase or both (complex), or the largest deviation of "
            "modulus or phase"
        ),
    ]
    band_Hz: Annotated[
        tuple[Positive, Positive],
        Field(strict=False, description="edges of a band [Hz]: 0.5-5, 5-20 or 20-50"),
    ]
    static_forces_N: Annotated[
        NonNegativeList,
        Field(max_length=50, description="static forces that must be measured [N]; one without a response is a skip"),
    ]
    heights_m: Annotated[
        NumberList | None,
        Field(
            max_length=50,
            description="heights of the head that must be measured under each static force [m]; default: every height "
            "that was measured",
        ),
    ] = None
    upper: Annotated[Positive, Field(le=1e4, description="largest accepted deviation, in the unit of the quantity")]
    source: Annotated[str, Field(min_length=1, max_length=500, description="source of the limit")] = NO_SOURCE
    note: Annotated[str | None, Field(description="reason for the limit", max_length=4000)] = None

    @cross_check
    def _check_band(self) -> Problems:
        if self.band_Hz not in RESPONSE_BANDS:
            names = ", ".join(str(list(band)) for band in RESPONSE_BANDS)
            yield validation_problem("band_Hz", f"{list(self.band_Hz)} is not a compared band", f"Give one of {names}.")

    @cross_check
    def _check_repetitions(self) -> Problems:
        for key in ("static_forces_N", "heights_m"):
            values = getattr(self, key) or ()
            if len(set(values)) < len(values):
                yield validation_problem(key, f"{list(values)} repeats a value", "Name each value once.")


class ResponseLimits(InputTable):
    """File of the limits of a response comparison."""

    schema_: Annotated[
        Literal["pantocheck.response-limits/1"],
        Field(alias="schema", description='version of the format: "pantocheck.response-limits/1"'),
    ]
    limit: Annotated[tuple[ResponseLimit, ...], Field(strict=False, min_length=1, max_length=1000)]


def read_response_limits(path: Path) -> ResponseLimits:
    """Read a file of limits.

    Raises
    ------
    InputError
        The file cannot be read, or does not fit the format.
    """
    return read_model(path, ResponseLimits, "limits")
