"""Bar charts of the contact force in frequency bands under several damping models."""

from collections.abc import Mapping, Sequence

from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.results.figure_data import Chart, Series

PrintedValues = Mapping[tuple[str, int], Mapping[str, float]]
"""Printed values of a publication by damping model and pantograph, then by name of quantity."""


def list_pantographs(values: Mapping[str, ValuesByOwner]) -> list[int]:
    """Numbers of all pantographs with values, in running order."""
    return sorted({number for model_values in values.values() for number in model_values if number != LINE})


def draw_band_bars(
    values: Mapping[str, ValuesByOwner], printed: PrintedValues, bands: Sequence[str]
) -> tuple[Chart, ...]:
    """Draw one bar chart per pantograph: computed and printed RMS of the contact force in each band.

    Args:
        values: Computed values by damping model.
        printed: Printed values; may be empty.
        bands: Names of the quantities.

    Returns:
        Charts in the order of the pantographs.
    """
    origin = "computed on the assumed line and printed" if printed else "computed under each damping model"
    table = "computed and printed values" if printed else "the same run under several damping models"
    charts = []
    for p in list_pantographs(values):
        series = [_draw_bars(f"computed, {model}", computed.get(p, {}), bands) for model, computed in values.items()]
        series += [
            _draw_bars(f"printed, {model}", printed[model, p], bands) for model in values if (model, p) in printed
        ]
        charts.append(
            Chart(
                caption=f"Pantograph {p}: RMS of the contact force by band, {origin}.",
                alternative=f"The bars show the numbers in the table of {table}.",
                x_label="band [Hz]",
                y_label="RMS [N]",
                ticks=[band.removeprefix("rms_").removesuffix("_N").replace("_", "–") for band in bands],
                series=[bars for bars in series if bars.x],
            )
        )
    return tuple(charts)


def _draw_bars(label: str, values: Mapping[str, Value], bands: Sequence[str]) -> Series:
    known = {float(i): value for i, band in enumerate(bands) if isinstance(value := values.get(band), float)}
    return Series(label=label, style="bars", x=list(known), y=list(known.values()))
