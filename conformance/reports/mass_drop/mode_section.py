"""Section on the modes of an identification: half-power bands, shapes at the sensors, table."""

from collections.abc import Callable, Iterator, Sequence

from pantocheck.conformance.identification.identification_format import HalfPowerLines, IdentifiedLine
from pantocheck.conformance.identification.mode import Mode
from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.half_power_figure import draw_half_power
from pantocheck.conformance.reports.figures.shape_figure import draw_shapes
from pantocheck.conformance.reports.mass_drop.shape_rows import list_measured_shapes, list_supports
from pantocheck.conformance.reports.page_text import format_percent, format_value

MODES_TEXT = (
    "Uncertainties are one standard deviation: the Cramér-Rao bound with the noise estimated from the residual, "
    "widened where the residual around a mode exceeds noise. Error: residual of the fit in the band of the mode, "
    "relative to the measured spectrum."
)


def list_mode_blocks(line: IdentifiedLine) -> Iterator[doc.Block]:
    """Explanation, figures and table of the modes of one line of identification.json."""
    yield doc.Paragraph(MODES_TEXT)
    yield from _half_power(line)
    if columns := list_measured_shapes(line.modes):
        groups = " and ".join(column.title for column in columns)
        figure = doc.Figure(
            draw_shapes(columns, list_supports(line.spans_m)),
            f"Real part of the mode shapes at the sensors, {groups}; each shape is scaled to its largest component. "
            "The numbers are in modes.json.",
            f"Mode shapes at the sensors, {groups}: real part over the position; vertical lines are supports.",
        )
        yield doc.Figures((figure,))
    yield _mode_table(line.modes)


def _half_power(line: IdentifiedLine) -> Iterator[doc.Block]:
    """One sentence and one figure on the spectral lines in the half-power bands; nothing for results without them."""
    if not (counts := line.half_power).modes:
        return
    yield doc.Paragraph(describe_half_power(counts))
    figure = doc.Figure(
        draw_half_power(line.modes, counts.recommended),
        f"Spectral lines in the half-power band of each mode over frequency. {describe_half_power(counts)}",
        "Spectral lines in the half-power band of each mode; dashed line: recommended number.",
    )
    yield doc.Figures((figure,))


def describe_half_power(counts: HalfPowerLines) -> str:
    """Sentences on the spectral lines in the half-power bands, by the `half_power` of a line."""
    recommended = counts.recommended
    if not counts.fewer:
        return f"Every mode has at least {recommended} spectral lines in its half-power band."
    needed = counts.needed_s
    record = "" if needed is None else f"; a linear decay of {format_value(needed, 3)} s would give them to every mode"
    return (
        f"{counts.fewer} of {counts.modes} modes have fewer than {recommended} spectral lines in their "
        f"half-power band{record}. Methods that read this band from a spectrum need them; the fit of decays does not."
    )


def _mode_table(modes: Sequence[Mode]) -> doc.Table:
    cells: dict[str, Callable[[Mode], str]] = {
        "f [Hz]": lambda mode: format_value(mode.frequency_Hz, 6),
        "± [mHz]": lambda mode: format_value(None if mode.frequency_std_Hz is None else 1e3 * mode.frequency_std_Hz, 2),
        "ζ [%]": lambda mode: format_percent(mode.damping_ratio),
        "± [% of ζ]": lambda mode: format_value(100 * mode.damping_ratio_std / mode.damping_ratio, 2),
        "Group": lambda mode: "–" if mode.group is None else str(mode.group),
        "Collinearity": lambda mode: format_value(mode.phase_collinearity, 4),
        "Error [%]": lambda mode: format_percent(mode.error, 2),
        "Warnings": lambda mode: "; ".join(mode.warnings) or "–",
    }
    return doc.make_grid("Modes by frequency", modes, cells)
