"""Highest frequencies that the pantographs of a case support, and facts on the waves and modes of its line."""

import math
from collections.abc import Iterator

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import source_text
from pantocheck.conformance.line.elements.wire import ContactWireTable
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.results.supported_frequency import SupportedFrequency, name_pantograph_part
from pantocheck.conformance.runs.system import Delivered
from pantocheck.model.fem.beam import wave_speed

POISSON_RATIO = 0.34
"""Ratio of lateral to axial strain of copper."""

BASES = {"measured_response": "comparison with measured responses", "missing_mode": "first missing mode"}


def list_supported_frequencies(case: Case, delivered: Delivered) -> list[SupportedFrequency]:
    """Frequencies that follow from the files of a case, and those of the system that delivers it."""
    return [*list_case_frequencies(case), *delivered.supported]


def list_case_frequencies(case: Case) -> Iterator[SupportedFrequency]:
    """Frequencies that follow from the files of a case, whichever system simulates it; none for a line at rest."""
    if case.is_static or not case.pantographs:
        return
    for number, file in enumerate(case.pantographs, 1):
        yield _describe_pantograph(number, file)
    wire, first = case.line.contact_wire, case.analysed_spans[0]
    x = case.line.layout.spans[first - 1].dropper_position
    if x.size > 1:
        distance = float(np.diff(x).max())
        yield SupportedFrequency(
            part="dropper spacing",
            frequency_Hz=_round(wave_speed(wire.tension_N, wire.mass_kg_m) / (2 * distance)),
            basis=f"half a wave of the contact wire between droppers {distance:g} m apart; above it, clamps and "
            "stiffness of single droppers act on the force",
            limits=False,
        )
    yield SupportedFrequency(
        part="torsion of the contact wire",
        frequency_Hz=_find_torsion(wire, case.line.geometry.longest_span),
        basis="first mode of a round wire of copper between two supports, from bending stiffness and cross-section; "
        "the model leaves torsion out, which a vertical force on the axis does not excite",
        limits=False,
    )


def _describe_pantograph(number: int, file: PantographFile) -> SupportedFrequency:
    part, validity = name_pantograph_part(number), file.validity
    if validity is None:
        return SupportedFrequency(
            part=part, frequency_Hz=None, basis="no measured response, and no source for the first missing mode"
        )
    source = source_text((validity.source,) if isinstance(validity.source, str) else tuple(validity.source))
    return SupportedFrequency(
        part=part, frequency_Hz=validity.supported_to_Hz, basis=f"{BASES[validity.basis]}: {source}"
    )


def _find_torsion(wire: ContactWireTable, span: float) -> float | None:
    """First torsional frequency c / (2 L) of a round wire, c = sqrt(G / density) [Hz]; None without a cross-section.

    Cross-section A and bending stiffness EI give Young's modulus E = 4 pi EI / A^2 and the shear modulus
    G = E / (2 (1 + nu)). Grooves make a wire softer.
    """
    if wire.area_mm2 is None or not wire.bending_stiffness_N_m2:
        return None
    area = 1e-6 * wire.area_mm2
    modulus = 4 * math.pi * wire.bending_stiffness_N_m2 / area**2
    return _round(wave_speed(modulus / (2 * (1 + POISSON_RATIO)), wire.mass_kg_m / area) / (2 * span))


def _round(frequency: float) -> float:
    return float(f"{frequency:.4g}")
