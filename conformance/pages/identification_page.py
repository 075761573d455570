"""Report on an identification, from identification.json."""

from collections.abc import Callable, Iterator, Sequence

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages import identification_figures as figures
from pantocheck.conformance.pages.drop_figures import draw_motion
from pantocheck.conformance.pages.identification_sections import (
    list_fit_blocks,
    list_mode_blocks,
    list_record_blocks,
    list_response_figures,
)
from pantocheck.conformance.pages.words import clean_tree, format_percent, format_value
from pantocheck.conformance.results.identification_format import Comparison, IdentifiedLine, ModeGroup, Overlay
from pantocheck.conformance.results.identified_modes import Mode


def build_identification_document(lines: Sequence[IdentifiedLine]) -> doc.Document:
    """The report on the lines of an identification."""
    lines = [clean_tree(line.rounded()) for line in lines]
    modes = [mode for line in lines for mode in line.modes]
    certain = sum(mode.certain and not mode.lateral for mode in modes)
    headline = f"{certain} modes identified with a damping ratio known to better than 5 %"
    headline += f"; {len(modes) - certain} more are uncertain or lateral." if len(modes) > certain else "."
    header = doc.PlainHeader("Identification of mass drops", headline)
    warnings = collect_warnings(lines)
    blocks: list[doc.Block] = [doc.WarningBox(warnings)] if warnings else []
    for line in lines:
        names = ", ".join(record.name for record in line.records)
        blocks += _list_sections(line, f" ({names})" if len(lines) > 1 else "")
    return doc.Document(header.heading, header, tuple(blocks))


def collect_warnings(lines: Sequence[IdentifiedLine]) -> tuple[str, ...]:
    """Warnings of all lines, each once."""
    return tuple(dict.fromkeys(text for line in lines for text in line.warnings))


def _list_sections(line: IdentifiedLine, suffix: str) -> Iterator[doc.Section]:
    yield doc.Section(f"Damping{suffix}", (*_damping_figures(line.modes), _group_table(line.groups)))
    yield doc.Section(f"Modes{suffix}", tuple(list_mode_blocks(line)))
    # The records stand before the fit: its tall figure starts a page, and they fill the one before.
    yield doc.Section(f"Records{suffix}", tuple(list_record_blocks(line)))
    yield doc.Section(f"Fit{suffix}", tuple(list_fit_blocks(line)))
    if motion := tuple(_list_motion_figures(line.overlays)):
        yield doc.Section(f"Motion{suffix}", (doc.Figures(motion),))
    if line.repeatability:
        yield doc.Section(f"Repeatability{suffix}", tuple(_repeatability(line)))
    if response_figures := tuple(list_response_figures(line)):
        yield doc.Section(f"Frequency responses{suffix}", (doc.Figures(response_figures),))


def _damping_figures(modes: Sequence[Mode]) -> tuple[doc.Figures, ...]:
    if not modes:
        return ()
    boxes = doc.Figure(
        figures.draw_boxes(modes),
        "Box plots of the damping ratio of each group of span modes; the numbers are in the table of groups.",
        "Damping ratio per group of span modes: quartiles, median, modes, outliers; without uncertain modes.",
    )
    ratios = doc.Figure(
        figures.draw_damping(modes),
        "Damping ratio over frequency with error bars; the numbers are in the table of modes.",
        "Damping ratio of every mode with its 95 % interval.",
    )
    return (doc.Figures((boxes, ratios)),)


def _group_table(groups: Sequence[ModeGroup]) -> doc.Table:
    cells: dict[str, Callable[[ModeGroup], str]] = {
        "Group": lambda group: str(group.group),
        "Frequency [Hz]": lambda group: f"{format_value(group.from_Hz)}–{format_value(group.to_Hz)}",
        "Certain modes": lambda group: f"{group.certain} of {group.modes}",
        "Median damping ratio [%]": lambda group: format_percent(group.median_damping_ratio),
        "Range [%]": lambda group: f"{format_percent(group.lowest)} to {format_percent(group.highest)}",
    }
    return doc.make_grid("Groups of span modes", groups, cells)


def _list_motion_figures(overlays: Sequence[Overlay]) -> Iterator[doc.Figure]:
    for overlay in overlays:
        names = [run.name for run in overlay.runs if run.windows]
        if names:
            later = max(len(run.windows) for run in overlay.runs) > 1
            windows = "in the first ten seconds" + (" and a minute later" if later else "")
            yield doc.Figure(
                draw_motion(overlay.runs),
                f"Velocity and acceleration at {overlay.channel} after the release, {windows}: "
                f"{', '.join(names)}, laid over each other.",
                f"Velocity and acceleration at {overlay.channel}, {windows}; low-passed at 6 Hz.",
            )


def _repeatability(line: IdentifiedLine) -> Iterator[doc.Block]:
    for result in line.repeatability:
        yield doc.Paragraph(f"{result.verdict.capitalize()}: {result.reason}.")
    cells: dict[str, Callable[[Comparison], str]] = {
        "Records": lambda pair: f"{pair.first} / {pair.second}",
        "Channel": lambda pair: pair.channel,
        "Correlation, start": lambda pair: format_value(pair.correlation_at_start, 5),
        "Correlation, a minute later": lambda pair: format_value(pair.correlation_later, 5),
        "Residual [%], start": lambda pair: format_percent(pair.residual_at_start, 3),
        "Residual [%], a minute later": lambda pair: format_percent(pair.residual_later, 3),
    }
    for result in line.repeatability:
        yield doc.make_grid("Repeats compared below 6 Hz over ten seconds", result.comparisons, cells)
