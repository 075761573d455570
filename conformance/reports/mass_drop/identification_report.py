"""Report on an identification, from identification.json."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.reports.document import (
    Block,
    Document,
    Figure,
    Figures,
    Paragraph,
    PlainHeader,
    Section,
    Table,
    WarningBox,
    make_grid,
)
from pantocheck.conformance.reports.figures import identification_figures as figures
from pantocheck.conformance.reports.page_text import clean_tree, format_value

UNITS = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}
MODES_TEXT = (
    "Uncertainties are one standard deviation: the Cramér-Rao bound with the noise estimated from the residual, "
    "widened where the residual around a mode exceeds noise. Error: residual of the fit in the band of the mode, "
    "relative to the measured spectrum."
)


def build_identification_document(lines: list[dict[str, Any]]) -> Document:
    """The report.

    Parameters
    ----------
    lines : list of dict
        `lines` of identification.json.
    """
    lines = clean_tree(lines)
    modes = [mode for line in lines for mode in line["modes"]]
    certain = [mode for mode in modes if mode["certain"] and not mode["lateral"]]
    doubtful = len(modes) - len(certain)
    headline = f"{len(certain)} modes identified with a damping ratio known to better than 5 %"
    headline += f"; {doubtful} more are uncertain or lateral." if doubtful else "."
    header = PlainHeader("Identification of mass drops", headline)
    warnings = collect_warnings(lines)
    blocks: list[Block] = [WarningBox(warnings)] if warnings else []
    for line in lines:
        names = ", ".join(record["name"] for record in line["records"])
        blocks += _list_sections(line, f" ({names})" if len(lines) > 1 else "")
    return Document(header.heading, header, tuple(blocks))


def collect_warnings(lines: list[dict[str, Any]]) -> tuple[str, ...]:
    """Warnings of all lines, each once."""
    return tuple(dict.fromkeys(text for line in lines for text in line["warnings"]))


def _list_sections(line: dict[str, Any], suffix: str) -> Iterator[Section]:
    unit = UNITS[line["quantity"]]
    spectra = tuple(_spectrum(data, unit) for data in line["spectra"])
    yield Section(f"Damping{suffix}", (*_damping_figures(line), _groups(line)))
    yield Section(f"Modes{suffix}", (Paragraph(MODES_TEXT), _modes(line)))
    yield Section(f"Fit{suffix}", (Paragraph(_describe_fit(line)), Figures(spectra)))
    if line["repeatability"]:
        yield Section(f"Repeatability{suffix}", tuple(_repeatability(line, unit)))
    if line["frequency_responses"]:
        yield Section(f"Frequency responses{suffix}", (Figures((_response(line["frequency_responses"][0]),)),))
    yield Section(f"Records{suffix}", (_records(line),))


def _describe_fit(line: dict[str, Any]) -> str:
    return (
        f"The squared residual is {format_value(line['misfit'], 3)} times that of noise alone "
        f"(1 for a complete model); modes between {line['band_Hz'][0]:g} and {line['band_Hz'][1]:g} Hz."
    )


def _damping_figures(line: dict[str, Any]) -> tuple[Figures, ...]:
    if not line["modes"]:
        return ()
    boxes = Figure(
        figures.draw_boxes(line["modes"]),
        "Box plots of the damping ratio of each group of span modes; the numbers are in the table of groups.",
        "Damping ratio per group of span modes: quartiles, median, modes, outliers; without uncertain modes.",
    )
    ratios = Figure(
        figures.draw_damping(line["modes"]),
        "Damping ratio over frequency with error bars; the numbers are in the table of modes.",
        "Damping ratio of every mode with its 95 % interval.",
    )
    return (Figures((boxes, ratios)),)


def _groups(line: dict[str, Any]) -> Table:
    rows = [
        (
            str(group["group"]),
            f"{format_value(group['from_Hz'])}–{format_value(group['to_Hz'])}",
            f"{group['certain']} of {group['modes']}",
            _percent(group["median_damping_ratio"]),
            f"{_percent(group['lowest'])} to {_percent(group['highest'])}",
        )
        for group in line["groups"]
    ]
    headings = ("Group", "Frequency [Hz]", "Certain modes", "Median damping ratio [%]", "Range [%]")
    return make_grid("Groups of span modes", headings, rows)


def _modes(line: dict[str, Any]) -> Table:
    rows = [
        (
            format_value(mode["frequency_Hz"], 6),
            format_value(1e3 * mode["frequency_std_Hz"], 2),
            _percent(mode["damping_ratio"]),
            format_value(100 * mode["damping_ratio_std"] / mode["damping_ratio"], 2),
            "–" if mode["group"] is None else str(mode["group"]),
            format_value(mode["phase_collinearity"], 4),
            format_value(100 * mode["error"], 2),
            "; ".join(_shorten(text) for text in mode["warnings"]) or "–",
        )
        for mode in line["modes"]
    ]
    headings = ("f [Hz]", "± [mHz]", "ζ [%]", "± [% of ζ]", "Group", "Collinearity", "Error [%]", "Warnings")
    return make_grid("Modes by frequency", headings, rows)


def _shorten(warning: str) -> str:
    return warning.split(";", maxsplit=1)[0] if warning.startswith("half-power") else warning


def _spectrum(data: dict[str, Any], unit: str) -> Figure:
    return Figure(
        figures.draw_spectra(data, unit),
        f"Spectra of the vertical sensors of {data['record']} with the identified fit over them.",
        f"{data['record']}: spectrum of the free decay, the identified modes and the residual.",
    )


def _repeatability(line: dict[str, Any], unit: str) -> Iterator[Block]:
    for result in line["repeatability"]:
        yield Paragraph(f"{result['verdict'].capitalize()}: {result['reason']}.")
    overlays = tuple(
        Figure(
            figures.draw_overlay(overlay["runs"], overlay["channel"], unit),
            "Repeats of the drop laid over each other; their correlations are in the table.",
            f"Repeats at {overlay['channel']} at the start and a minute later.",
        )
        for overlay in line["overlays"]
    )
    if overlays:
        yield Figures(overlays)
    headings = ("Records", "Channel", "Correlation, start", "a minute later", "Residual [%], start", "a minute later")
    for result in line["repeatability"]:
        rows = [
            (
                f"{pair['first']} / {pair['second']}",
                pair["channel"],
                format_value(pair["correlation_at_start"], 5),
                format_value(pair["correlation_later"], 5),
                format_value(100 * pair["residual_at_start"], 3),
                format_value(None if pair["residual_later"] is None else 100 * pair["residual_later"], 3),
            )
            for pair in result["comparisons"]
        ]
        yield make_grid("Repeats compared below 6 Hz over ten seconds", headings, rows)


def _response(data: dict[str, Any]) -> Figure:
    return Figure(
        figures.draw_responses(data),
        f"Magnitude and phase of the frequency responses of {data['record']}, measured and identified.",
        f"{data['record']}: accelerance, with the release as a step force m g.",
    )


def _records(line: dict[str, Any]) -> Table:
    rows = [
        (
            record["name"],
            f"{format_value(record['mass_kg'], 3)} kg, {record['drop_wire'] or '?'} "
            f"at {format_value(record['drop_position_m'])} m",
            f"{format_value(record['length_s'])} s at {record['sampling_rate_Hz']:g} Hz",
            f"{format_value(record['used_from_s'] - record['release_s'], 3)}–"
            f"{format_value(record['used_to_s'] - record['release_s'])} s",
            ", ".join(record["channels"]),
        )
        for record in line["records"]
    ]
    headings = ("Record", "Drop", "Recording", "Used after the release", "Channels")
    return make_grid("Records and the part of each that was used", headings, rows)


def _percent(ratio: float | None) -> str:
    return format_value(None if ratio is None else 100 * ratio, 4)
