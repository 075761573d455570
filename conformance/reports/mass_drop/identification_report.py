"""Report on an identification, from identification.json."""

from collections.abc import Iterator
from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures import identification_figures as figures
from pantocheck.conformance.reports.figures.half_power_figure import draw_half_power
from pantocheck.conformance.reports.page_text import clean_tree, format_percent, format_value

UNITS = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}
MODES_TEXT = (
    "Uncertainties are one standard deviation: the Cramér-Rao bound with the noise estimated from the residual, "
    "widened where the residual around a mode exceeds noise. Error: residual of the fit in the band of the mode, "
    "relative to the measured spectrum."
)


def build_identification_document(lines: list[dict[str, Any]]) -> doc.Document:
    """The report on the `lines` of identification.json."""
    lines = clean_tree(lines)
    modes = [mode for line in lines for mode in line["modes"]]
    certain = sum(mode["certain"] and not mode["lateral"] for mode in modes)
    headline = f"{certain} modes identified with a damping ratio known to better than 5 %"
    headline += f"; {len(modes) - certain} more are uncertain or lateral." if len(modes) > certain else "."
    header = doc.PlainHeader("Identification of mass drops", headline)
    warnings = collect_warnings(lines)
    blocks: list[doc.Block] = [doc.WarningBox(warnings)] if warnings else []
    for line in lines:
        names = ", ".join(record["name"] for record in line["records"])
        blocks += _list_sections(line, f" ({names})" if len(lines) > 1 else "")
    return doc.Document(header.heading, header, tuple(blocks))


def collect_warnings(lines: list[dict[str, Any]]) -> tuple[str, ...]:
    """Warnings of all lines, each once."""
    return tuple(dict.fromkeys(text for line in lines for text in line["warnings"]))


def _list_sections(line: dict[str, Any], suffix: str) -> Iterator[doc.Section]:
    unit = UNITS[line["quantity"]]
    yield doc.Section(f"Damping{suffix}", (*_damping_figures(line["modes"]), _group_table(line["groups"])))
    yield doc.Section(f"Modes{suffix}", (doc.Paragraph(MODES_TEXT), *_half_power(line), _mode_table(line["modes"])))
    # The records stand before the fit: its tall figure starts a page, and they fill the one before.
    yield doc.Section(f"Records{suffix}", (_record_table(line["records"]),))
    yield doc.Section(f"Fit{suffix}", tuple(_fit(line, unit)))
    if line["repeatability"]:
        yield doc.Section(f"Repeatability{suffix}", tuple(_repeatability(line, unit)))
    for data in line["frequency_responses"][:1]:
        figure = doc.Figure(
            figures.draw_responses(data),
            f"Magnitude and phase of the frequency responses of {data['record']}, measured and identified.",
            f"{data['record']}: accelerance, with the release as a step force m g.",
        )
        yield doc.Section(f"Frequency responses{suffix}", (doc.Figures((figure,)),))


def _damping_figures(modes: list[dict[str, Any]]) -> tuple[doc.Figures, ...]:
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


def _half_power(line: dict[str, Any]) -> Iterator[doc.Block]:
    """One sentence and one figure on the spectral lines in the half-power bands; nothing for results without them."""
    if (counts := line.get("half_power")) is None or not counts["modes"]:
        return
    yield doc.Paragraph(describe_half_power(counts))
    figure = doc.Figure(
        draw_half_power(line["modes"], counts["recommended"]),
        f"Spectral lines in the half-power band of each mode over frequency. {describe_half_power(counts)}",
        "Spectral lines in the half-power band of each mode; dashed line: recommended number.",
    )
    yield doc.Figures((figure,))


def describe_half_power(counts: dict[str, Any]) -> str:
    """Sentences on the spectral lines in the half-power bands, by the `half_power` of a line."""
    recommended = counts["recommended"]
    if not counts["fewer"]:
        return f"Every mode has at least {recommended} spectral lines in its half-power band."
    needed = counts["needed_s"]
    record = "" if needed is None else f"; a linear decay of {format_value(needed, 3)} s would give them to every mode"
    return (
        f"{counts['fewer']} of {counts['modes']} modes have fewer than {recommended} spectral lines in their "
        f"half-power band{record}. Methods that read this band from a spectrum need them; the fit of decays does not."
    )


def _group_table(groups: list[dict[str, Any]]) -> doc.Table:
    cells = {
        "Group": lambda group: str(group["group"]),
        "Frequency [Hz]": lambda group: f"{format_value(group['from_Hz'])}–{format_value(group['to_Hz'])}",
        "Certain modes": lambda group: f"{group['certain']} of {group['modes']}",
        "Median damping ratio [%]": lambda group: format_percent(group["median_damping_ratio"]),
        "Range [%]": lambda group: f"{format_percent(group['lowest'])} to {format_percent(group['highest'])}",
    }
    return doc.make_grid("Groups of span modes", groups, cells)


def _mode_table(modes: list[dict[str, Any]]) -> doc.Table:
    cells = {
        "f [Hz]": lambda mode: format_value(mode["frequency_Hz"], 6),
        "± [mHz]": lambda mode: format_value(1e3 * mode["frequency_std_Hz"], 2),
        "ζ [%]": lambda mode: format_percent(mode["damping_ratio"]),
        "± [% of ζ]": lambda mode: format_value(100 * mode["damping_ratio_std"] / mode["damping_ratio"], 2),
        "Group": lambda mode: "–" if mode["group"] is None else str(mode["group"]),
        "Collinearity": lambda mode: format_value(mode["phase_collinearity"], 4),
        "Error [%]": lambda mode: format_percent(mode["error"], 2),
        "Warnings": lambda mode: "; ".join(mode["warnings"]) or "–",
    }
    return doc.make_grid("Modes by frequency", modes, cells)


def _record_table(records: list[dict[str, Any]]) -> doc.Table:
    def drop(record: dict[str, Any]) -> str:
        place = f"{record['drop_wire'] or '?'} at {format_value(record['drop_position_m'])} m"
        return f"{format_value(record['mass_kg'], 3)} kg, {place}"

    def analysed(record: dict[str, Any]) -> str:
        start, end = (record[key] - record["release_s"] for key in ("used_from_s", "used_to_s"))
        return f"{format_value(start, 3)}–{format_value(end)} s"

    cells = {
        "Record": lambda record: record["name"],
        "Drop": drop,
        "Recording": lambda record: f"{format_value(record['length_s'])} s at {record['sampling_rate_Hz']:g} Hz",
        "Used after the release": analysed,
        "Channels": lambda record: ", ".join(record["channels"]),
    }
    return doc.make_grid("Records and the part of each that was used", records, cells)


def _fit(line: dict[str, Any], unit: str) -> Iterator[doc.Block]:
    yield doc.Paragraph(
        f"The squared residual is {format_value(line['misfit'], 3)} times that of noise alone "
        f"(1 for a complete model); modes between {line['band_Hz'][0]:g} and {line['band_Hz'][1]:g} Hz."
    )
    yield doc.Figures(
        tuple(
            doc.Figure(
                figures.draw_spectra(data, unit),
                f"Spectra of the vertical sensors of {data['record']} with the identified fit over them.",
                f"{data['record']}: spectrum of the free decay, the identified modes and the residual.",
            )
            for data in line["spectra"]
        )
    )


def _repeatability(line: dict[str, Any], unit: str) -> Iterator[doc.Block]:
    for result in line["repeatability"]:
        yield doc.Paragraph(f"{result['verdict'].capitalize()}: {result['reason']}.")
    overlays = tuple(
        doc.Figure(
            figures.draw_overlay(overlay["runs"], overlay["channel"], unit),
            "Repeats of the drop laid over each other; their correlations are in the table.",
            f"Repeats at {overlay['channel']} at the start and a minute later.",
        )
        for overlay in line["overlays"]
    )
    if overlays:
        yield doc.Figures(overlays)
    cells = {
        "Records": lambda pair: f"{pair['first']} / {pair['second']}",
        "Channel": lambda pair: pair["channel"],
        "Correlation, start": lambda pair: format_value(pair["correlation_at_start"], 5),
        "Correlation, a minute later": lambda pair: format_value(pair["correlation_later"], 5),
        "Residual [%], start": lambda pair: format_percent(pair["residual_at_start"], 3),
        "Residual [%], a minute later": lambda pair: format_percent(pair["residual_later"], 3),
    }
    for result in line["repeatability"]:
        yield doc.make_grid("Repeats compared below 6 Hz over ten seconds", result["comparisons"], cells)
