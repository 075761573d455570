"""Section on the fit of an identification: residual, model order and spectra."""

from collections.abc import Iterator

from pantocheck.conformance.identification.identification_format import IdentifiedLine, OrderSearch, RecordSpectra
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.identification_figures import draw_spectra
from pantocheck.conformance.reports.figures.order_figure import draw_order_search
from pantocheck.conformance.reports.page_text import format_value

UNITS = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}


def list_fit_blocks(line: IdentifiedLine) -> Iterator[doc.Block]:
    """Residual, search for the model order and spectra of one line of identification.json."""
    yield doc.Paragraph(
        f"The squared residual is {format_value(line.misfit, 3)} times that of noise alone "
        f"(1 for a complete model); modes between {line.band_Hz[0]:g} and {line.band_Hz[1]:g} Hz."
    )
    if line.order_search.bands:
        yield doc.Figures((_order_figure(line.order_search),))
    yield doc.Figures(
        tuple(
            doc.Figure(
                draw_spectra(data, UNITS[line.quantity]),
                f"Spectra of the vertical sensors of {data.record} with the identified fit over them.",
                f"{data.record}: spectrum of the free decay, the identified modes and the residual.",
            )
            for data in _skip_repeats(line)
        )
    )


def _skip_repeats(line: IdentifiedLine) -> list[RecordSpectra]:
    """Spectra of the first record of each drop: those of its repeats look alike."""
    first: dict[str, RecordSpectra] = {}
    for record, spectra in zip(line.records, line.spectra, strict=True):
        drop = (record.mass_kg, record.drop_wire, record.drop_position_m, record.sensors)
        first.setdefault(repr(drop), spectra)
    return list(first.values())


def _order_figure(search: OrderSearch) -> doc.Figure:
    counts = "; ".join(f"{step.name}: {len(step.frequency_Hz)} poles" for step in search.steps)
    orders = ", ".join(str(band.selected_order) for band in search.bands)
    return doc.Figure(
        draw_order_search(search),
        f"Stabilisation diagram. {counts}. Selected orders of the bands, by frequency: {orders}.",
        "Search for the model order. Above: poles after each step. Below: poles of every order of the start search, "
        "stable from one order to the next or not; bars: order of each band with the lowest information criterion.",
    )
