"""Irregularity of a contact wire in a line file: measured heights, or a power spectral density with a seed."""

from itertools import pairwise
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.features import Feature
from pantocheck.conformance.input_files.sourced_table import Positive, SourcedTable, is_absent, validation_problem

MOST_POINTS = 50_000
"""Largest number of measured points: a height every 6 cm over 3 km."""
MOST_WAVES = 3000
"""Largest number of the shortest waves on a line: waves of 1 m over 3 km."""

MeasuredPositions = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=MOST_POINTS)]
MeasuredHeights = Annotated[
    tuple[Annotated[float, Field(ge=-0.5, le=0.5)], ...], Field(strict=False, min_length=2, max_length=MOST_POINTS)
]
SpectralValues = Annotated[tuple[Positive, ...], Field(strict=False, min_length=2, max_length=1000)]


class ScaledIrregularity(SourcedTable):
    """Irregularity with a common factor of its heights, which a campaign can vary."""

    height_factor: Annotated[
        float | None,
        Field(ge=0, le=100, description="factor of all heights; default: 1 [-]", exclude_if=is_absent),
        Feature("irregularity"),
    ] = None

    @property
    def scale(self) -> float:
        """Factor of all heights."""
        return 1.0 if self.height_factor is None else self.height_factor


class MeasuredIrregularity(ScaledIrregularity):
    """Heights of the contact wire that a pantograph feels in addition to those at rest, joined by a cubic spline."""

    x_m: Annotated[MeasuredPositions, Field(description="positions along the track, in increasing order [m]")]
    height_m: Annotated[
        MeasuredHeights, Field(description="additional heights [m]; beyond the positions that of the nearest end")
    ]

    @cross_check
    def _check_points(self) -> Problems:
        yield from _check_pairs("x_m", self.x_m, "height_m", self.height_m)


class SpectralIrregularity(ScaledIrregularity):
    """One-sided power spectral density of the additional heights, realised over the line with random phases."""

    frequency_1_m: Annotated[SpectralValues, Field(description="spatial frequencies, in increasing order [1/m]")]
    density_m3: Annotated[
        SpectralValues, Field(description="density at each frequency, log-log interpolated, zero outside of them [m3]")
    ]
    seed: Annotated[int, Field(ge=0, le=2**31 - 1, description="seed of the phases")]

    @cross_check
    def _check_points(self) -> Problems:
        yield from _check_pairs("frequency_1_m", self.frequency_1_m, "density_m3", self.density_m3)

    def check_resolution(self, length: float) -> Problems:
        """Problem of a spectrum with too many waves on a line of a length [m]."""
        highest = MOST_WAVES / length
        if self.frequency_1_m[-1] > highest:
            yield validation_problem(
                "contact_wire.irregularity.frequency_1_m",
                f"{self.frequency_1_m[-1]:g} 1/m is too high for a line of {length:g} m",
                f"Give frequencies up to {highest:.3g} 1/m: at most {MOST_WAVES} waves on the line.",
            )


def _check_pairs(first: str, places: tuple[float, ...], second: str, values: tuple[float, ...]) -> Problems:
    """Problems of a list of places and a list of values there."""
    if len(places) != len(values):
        yield validation_problem(second, f"{len(values)} values for {len(places)} of {first}", "Give one for each.")
    falling = next((n for n, (a, b) in enumerate(pairwise(places), 2) if b <= a), None)
    if falling is not None:
        yield validation_problem(
            f"{first}[{falling}]", f"{places[falling - 1]:g} follows {places[falling - 2]:g}", "Give increasing values."
        )


def _form_of_irregularity(table: Any) -> str:
    if isinstance(table, dict):
        return "SpectralIrregularity" if "density_m3" in table else "MeasuredIrregularity"
    return type(table).__name__


IrregularityTable = Annotated[
    Annotated[MeasuredIrregularity, Tag("MeasuredIrregularity")]
    | Annotated[SpectralIrregularity, Tag("SpectralIrregularity")],
    Discriminator(_form_of_irregularity),
]
