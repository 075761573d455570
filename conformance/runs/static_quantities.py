"""Quantities of a line at rest from the reference simulator, in its middle span or in every span."""

from collections.abc import Iterator

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.line.elements.element_registry import ELEMENTS
from pantocheck.conformance.line.geometry import ListedSpans
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.pantograph_model import build_pantograph
from pantocheck.conformance.quantities.evaluation import Value
from pantocheck.model import Catenary, DiscretisedLine, Kind, discretise
from pantocheck.model.description.one_thread import use_one_thread
from pantocheck.model.description.pantograph import apparent_mass
from pantocheck.model.discretisation.discretised_line import keep_with_line
from pantocheck.model.discretisation.string_statics import compute_string_state, remove_staggers
from pantocheck.model.fem.beam import wave_speed
from pantocheck.model.modal.modes import Modes, compute_modes
from pantocheck.model.statics.elasticity import non_uniformity, static_uplift
from pantocheck.model.statics.wave_factors import amplification_coefficient, doppler_factor, reflection_coefficient

SAMPLES_PER_SPAN = 24
"""Positions along a span at which the elasticity is computed."""
SMALL_LOAD = 1.0
"""Load that slackens no dropper [N]."""
LARGE_LOAD = 200.0
"""Load that slackens droppers [N]."""
SPANS_OF_MODES = 10
"""Number of spans for the natural frequencies: with more spans the frequencies lie closer together."""
MODES = 10
"""Number of natural frequencies."""


def compute_static_quantities(case: Case, line: DiscretisedLine) -> dict[str, Value]:
    """Quantities of a line at rest, in its middle span.

    Args:
        case: Case of the line.
        line: Line of the case in finite elements.

    Returns:
        Values by name of quantity.
    """
    span = case.line.geometry.span(case.line.middle_span)
    presags = _presags(case.line, line)[_droppers(line.catenary, *span)]
    quantities: dict[str, Value] = {"presag_mm": tuple(map(float, presags))}
    quantities |= _dropper_lengths(line, *span) | _elasticity(line, *span) | _waves(case, line.catenary)
    for element in ELEMENTS:
        quantities |= element.measure(case.line, line)
    if case.is_static:
        if case.static_pantograph is not None and case.file.apparent_mass is not None:
            pantograph = build_pantograph(case.static_pantograph, 0.0, 0.0)
            response = apparent_mass(pantograph, np.array(case.file.apparent_mass.frequency_Hz))
            quantities["apparent_mass_kg"] = tuple(map(float, np.abs(response)))
        quantities["natural_frequency_Hz"] = tuple(map(float, first_modes(case.line, _element(line)).frequency))
    return quantities


def sample_span(start: float, end: float) -> RealArray:
    """Equidistant positions along a span, without its end [m]."""
    return start + (end - start) * np.arange(SAMPLES_PER_SPAN) / SAMPLES_PER_SPAN


def first_modes(line: LineFile, element: float) -> Modes:
    """First modes of a shortened line whose motion is mainly vertical.

    Args:
        line: Content of the line file.
        element: Longest element [m].

    Returns:
        Modes of the first spans of the line.
    """
    short = discretise_line(line.shorten(SPANS_OF_MODES), element)
    lateral = [row for row in range(short.mesh.rows) if short.mesh.row_field[row] == "y"]
    count = MODES * (2 if lateral else 1)
    while True:
        modes = compute_modes(short, count)
        size = (modes.shape[..., 0] ** 2).sum(axis=2)
        vertical = np.flatnonzero(size[:, lateral].sum(axis=1) < size.sum(axis=1) / 2)[:MODES]
        if vertical.size == MODES:
            return Modes(modes.frequency[vertical], modes.shape[vertical])
        count *= 2


def _droppers(catenary: Catenary, start: float, end: float) -> list[int]:
    """Indices of the droppers of a span."""
    return [i for i, dropper in enumerate(catenary.droppers) if start <= dropper.position < end]


def _element(line: DiscretisedLine) -> float:
    return float(np.diff(line.mesh.position).max())


def _presags(file: LineFile, line: DiscretisedLine) -> RealArray:
    """Pre-sag at every dropper, below the straight lines between the supports [mm]."""
    droppers, mesh = line.catenary.droppers, line.mesh
    rows = [mesh.row_of[dropper.lower, "z"] for dropper in droppers]
    stations = [mesh.station(dropper.position) for dropper in droppers]
    chord = file.layout.chord_height(np.array([dropper.position for dropper in droppers]))
    return np.asarray(1e3 * (chord - line.state.deflection[rows, stations, 0]))


def _list_elasticities(line: DiscretisedLine, positions: RealArray) -> Iterator[tuple[str, RealArray]]:
    """Prefix of the name of each elasticity, and its values at positions (n,) [mm/N]."""
    for name, load in (("elasticity", SMALL_LOAD), ("elasticity_200_N", LARGE_LOAD)):
        yield name, np.asarray(1e3 * static_uplift(line, positions, load) / load)


@keep_with_line
def _dropper_lengths(line: DiscretisedLine, start: float, end: float) -> dict[str, Value]:
    """Lengths by string statics, with bending, and with bending and stagger, to show each effect."""
    droppers = _droppers(line.catenary, start, end)
    lengths = {"dropper_length_m": compute_string_state(line.catenary).dropper_length}
    if line.catenary.has_lateral_field:
        straight = discretise(remove_staggers(line.catenary), _element(line))
        lengths["dropper_length_bending_m"] = straight.state.dropper_length
        lengths["dropper_length_stagger_m"] = line.state.dropper_length
    else:
        lengths["dropper_length_bending_m"] = line.state.dropper_length
    return {name: tuple(map(float, length[droppers])) for name, length in lengths.items()}


@keep_with_line
def _elasticity(line: DiscretisedLine, start: float, end: float) -> dict[str, Value]:
    positions = sample_span(start, end)
    quantities: dict[str, Value] = {}
    for name, elasticity in _list_elasticities(line, positions):
        quantities[f"{name}_mm_N"] = float(elasticity.max())
        quantities[f"{name}_non_uniformity_pct"] = 100 * non_uniformity(elasticity)
        quantities[f"{name}_along_span_mm_N"] = tuple(map(float, elasticity))
    return quantities


def _waves(case: Case, catenary: Catenary) -> dict[str, Value]:
    contact = catenary.contact_wires
    messengers = [wire for wire in catenary.wires if wire.kind is Kind.MESSENGER_WIRE]
    c = wave_speed(contact[0].tension, contact[0].mass_per_length)
    reflection = reflection_coefficient(contact, messengers)
    quantities: dict[str, Value] = {"wave_speed_m_s": c, "reflection_coefficient": reflection}
    if not case.is_static and case.speed < c:
        doppler = doppler_factor(case.speed, c)
        quantities |= {
            "speed_over_wave_speed": case.speed / c,
            "doppler_factor": doppler,
            "amplification_coefficient": amplification_coefficient(reflection, doppler),
        }
    return quantities


# Quantities of every span of a line at rest, for lines whose spans differ.
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
    quantities = _elasticity_of_spans(file, line)
    if len(file.section_places) == 1:
        quantities["presag_along_line_mm"] = tuple(map(float, _presags(file, line)))
        quantities["dropper_length_along_line_m"] = tuple(map(float, line.state.dropper_length))
    return quantities


def _elasticity_of_spans(file: LineFile, line: DiscretisedLine) -> dict[str, Value]:
    spans = file.geometry.spans
    positions = np.concatenate([sample_span(*file.geometry.span(number)) for number in range(1, spans + 1)])
    quantities: dict[str, Value] = {}
    for name, along in _list_elasticities(line, positions):
        by_span = along.reshape(spans, SAMPLES_PER_SPAN)
        quantities[f"{name}_of_spans_mm_N"] = tuple(map(float, by_span.max(axis=1)))
        quantities[f"{name}_non_uniformity_of_spans_pct"] = tuple(100 * non_uniformity(span) for span in by_span)
        quantities[f"{name}_along_line_mm_N"] = tuple(map(float, along))
    return quantities
