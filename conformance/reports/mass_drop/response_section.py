"""Figures of the frequency responses of an identification."""

from collections.abc import Iterator

from pantocheck.conformance.identification.identification_format import IdentifiedLine
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.identification_figures import draw_responses
from pantocheck.conformance.reports.figures.response_zoom import draw_response_zoom
from pantocheck.conformance.reports.page_text import format_value

ZOOMED_GROUPS = 2
"""Number of groups of span modes in the zoom: these are narrow and lie far from each other."""

ZOOM_MARGIN = 0.1
"""Margin of the zoom below the first and above the last group, relative to their frequency [-]."""


def list_response_figures(line: IdentifiedLine) -> Iterator[doc.Figure]:
    """Frequency responses of the first record of a line: the first two groups, then the whole band."""
    for data in line.frequency_responses[:1]:
        modes = [mode.frequency_Hz for mode in line.modes]
        if zoomed := line.groups[:ZOOMED_GROUPS]:
            zoom = (zoomed[0].from_Hz * (1 - ZOOM_MARGIN), zoomed[-1].to_Hz * (1 + ZOOM_MARGIN))
            yield doc.Figure(
                draw_response_zoom(data, modes, zoom),
                f"Magnitude of the frequency responses of {data.record} from {format_value(zoom[0], 3)} Hz to "
                f"{format_value(zoom[1], 3)} Hz, measured and identified.",
                f"{data.record}: accelerance in the first {len(zoomed)} groups of span modes.",
            )
        yield doc.Figure(
            draw_responses(data),
            f"Magnitude and phase of the frequency responses of {data.record}, measured and identified.",
            f"{data.record}: accelerance, with the release as a step force m g.",
        )
