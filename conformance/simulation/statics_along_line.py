"""Quantities of every span of a line at rest, for lines whose spans differ."""

import numpy as np

from pantocheck.conformance.cases.geometry import ListedSpans
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.conformance.simulation.static_quantities import LARGE_LOAD, SAMPLES_PER_SPAN, SMALL_LOAD, sample_span
from pantocheck.model import DiscretisedLine
from pantocheck.model.one_thread import use_one_thread
from pantocheck.model.statics.elasticity import non_uniformity, static_uplift


@use_one_thread
def compute_quantities_along_line(file: LineFile, line: DiscretisedLine) -> dict[str, Value]:
    """Elasticity, pre-sag and dropper lengths of every span; none for equal spans, whose middle span is described.

    With several tension sections only the elasticity: a span of an overlap has the droppers of both.

    Args:
        file: Content of the line file.
        line: Its finite elements.

    Returns:
        Values by name of quantity: per span, per position (24 per span), or per dropper.
    """
    if not isinstance(file.geometry, ListedSpans):
        return {}
    return _elasticity(file, line) | ({} if len(file.section_places) > 1 else _droppers(file, line))


def _elasticity(file: LineFile, line: DiscretisedLine) -> dict[str, Value]:
    spans = file.geometry.spans
    positions = np.concatenate([sample_span(*file.geometry.span(number)) for number in range(1, spans + 1)])
    quantities: dict[str, Value] = {}
    for name, load in (("elasticity", SMALL_LOAD), ("elasticity_200_N", LARGE_LOAD)):
        along = 1e3 * static_uplift(line, positions, load) / load
        by_span = along.reshape(spans, SAMPLES_PER_SPAN)
        quantities[f"{name}_of_spans_mm_N"] = tuple(map(float, by_span.max(axis=1)))
        quantities[f"{name}_non_uniformity_of_spans_pct"] = tuple(100 * non_uniformity(span) for span in by_span)
        quantities[f"{name}_along_line_mm_N"] = tuple(map(float, along))
    return quantities


def _droppers(file: LineFile, line: DiscretisedLine) -> dict[str, Value]:
    """Pre-sag below the straight lines between the supports, and lengths with bending and stagger."""
    droppers, mesh = line.catenary.droppers, line.mesh
    rows = [mesh.row_of[dropper.lower, "z"] for dropper in droppers]
    stations = [mesh.station(dropper.position) for dropper in droppers]
    chord = file.layout.chord_height(np.array([dropper.position for dropper in droppers]))
    return {
        "presag_along_line_mm": tuple(map(float, 1e3 * (chord - line.state.deflection[rows, stations, 0]))),
        "dropper_length_along_line_m": tuple(map(float, line.state.dropper_length)),
    }
