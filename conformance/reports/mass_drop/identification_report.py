"""The report of an identification, from identification.json alone."""

from typing import Any

from pantocheck.conformance.reports.document import Document, Grid, Picture, Section
from pantocheck.conformance.reports.figures import mass_drop_figures as figures
from pantocheck.conformance.reports.page_text import format_value

UNIT = {"acceleration": "m/s²", "velocity": "m/s", "displacement": "m"}


def build_identification_document(lines: list[dict[str, Any]]) -> Document:
    """The report.

    Parameters
    ----------
    lines : list[dict[str, Any]]
        Of identification.json, one entry per line.
    """
    modes = [mode for line in lines for mode in line["modes"]]
    certain = [mode for mode in modes if mode["certain"] and not mode["lateral"]]
    doubtful = len(modes) - len(certain)
    headline = f"{len(certain)} modes identified with a damping ratio known to better than 5 %"
    headline += f"; {doubtful} more are uncertain or lateral." if doubtful else "."
    sections = []
    for line in lines:
        names = ", ".join(record["name"] for record in line["records"])
        sections += _sections(line, f" ({names})" if len(lines) > 1 else "")
    warnings = tuple(dict.fromkeys(text for line in lines for text in line["warnings"]))
    return Document("Identification of mass drops", headline, warnings, tuple(sections))


def _sections(line: dict[str, Any], suffix: str) -> list[Section]:
    unit = UNIT[line["quantity"]]
    return [
        Section(f"Damping{suffix}", grids=(_groups(line),), pictures=_damping_pictures(line)),
        Section(f"Modes{suffix}", texts=(MODES_TEXT,), grids=(_modes(line),)),
        Section(f"Fit{suffix}", texts=(_fit_text(line),), pictures=tuple(_spectrum(s, unit) for s in line["spectra"])),
        *_repeatability(line, suffix, unit),
        *_responses(line, suffix),
        Section(f"Records{suffix}", grids=(_records(line),)),
    ]


MODES_TEXT = (
    "Uncertainties are one standard deviation: Cramér-Rao with the noise estimated from the residual, widened where "
    "the residual around a mode is more than noise. Error: what the fit leaves in the mode's band over what is "
    "measured there."
)


def _fit_text(line: dict[str, Any]) -> str:
    return (
        f"The squared residual is {format_value(line['misfit'], 3)} times what noise alone would leave "
        f"(1 for a complete model); modes between {line['band_Hz'][0]:g} and {line['band_Hz'][1]:g} Hz."
    )


def _damping_pictures(line: dict[str, Any]) -> tuple[Picture, ...]:
    if not line["modes"]:
        return ()
    return (
        Picture(
            figures.draw_boxes(line["modes"]),
            "Box plots of the damping ratio of each group of span modes; the numbers are in the table of groups.",
            "Damping ratio per group of span modes: quartiles, median, modes, outliers; without uncertain modes.",
        ),
        Picture(
            figures.draw_damping(line["modes"]),
            "Damping ratio over frequency with error bars; the numbers are in the table of modes.",
            "Damping ratio of every mode with its 95 % interval.",
        ),
    )


def _groups(line: dict[str, Any]) -> Grid:
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
    heads = ("Group", "Frequency [Hz]", "Certain modes", "Median damping ratio [%]", "Range [%]")
    return Grid(heads, tuple(rows), "Groups of span modes")


def _modes(line: dict[str, Any]) -> Grid:
    rows = [
        (
            format_value(mode["frequency_Hz"], 6),
            format_value(1e3 * mode["frequency_std_Hz"], 2),
            _percent(mode["damping_ratio"]),
            format_value(100 * mode["damping_ratio_std"] / mode["damping_ratio"], 2),
            "–" if mode["group"] is None else str(mode["group"]),
            format_value(mode["phase_collinearity"], 4),
            format_value(100 * mode["error"], 2),
            "; ".join(_short(text) for text in mode["warnings"]) or "–",
        )
        for mode in line["modes"]
    ]
    heads = ("f [Hz]", "± [mHz]", "ζ [%]", "± [% of ζ]", "Group", "Collinearity", "Error [%]", "Warnings")
    return Grid(heads, tuple(rows), "Modes by frequency")


def _short(text: str) -> str:
    return text.split(";", maxsplit=1)[0] if text.startswith("half-power") else text


def _spectrum(data: dict[str, Any], unit: str) -> Picture:
    return Picture(
        figures.draw_spectra(data, unit),
        f"Spectra of the vertical sensors of {data['record']} with the identified fit over them.",
        f"{data['record']}: transform of the free decay, the identified modes and what they leave.",
    )


def _repeatability(line: dict[str, Any], suffix: str, unit: str) -> list[Section]:
    if not line["repeatability"]:
        return []
    texts, grids = [], []
    for one in line["repeatability"]:
        texts.append(f"{one['verdict'].capitalize()}: {one['reason']}.")
        rows = [
            (
                f"{c['first']} / {c['second']}",
                c["channel"],
                format_value(c["correlation_at_start"], 5),
                format_value(c["correlation_later"], 5),
                format_value(100 * c["residual_at_start"], 3),
                format_value(None if c["residual_later"] is None else 100 * c["residual_later"], 3),
            )
            for c in one["comparisons"]
        ]
        heads = ("Records", "Channel", "Correlation, start", "a minute later", "Residual [%], start", "a minute later")
        grids.append(Grid(heads, tuple(rows), "Repeats compared below 6 Hz over ten seconds"))
    pictures = tuple(
        Picture(
            figures.draw_overlay(overlay["runs"], overlay["channel"], unit),
            "Repeats of the drop laid over each other; their correlations are in the table.",
            f"Repeats at {overlay['channel']} at the start and a minute later.",
        )
        for overlay in line["overlays"]
    )
    return [Section(f"Repeatability{suffix}", tuple(texts), tuple(grids), pictures)]


def _responses(line: dict[str, Any], suffix: str) -> list[Section]:
    pictures = tuple(
        Picture(
            figures.draw_responses(data),
            f"Magnitude and phase of the frequency responses of {data['record']}, measured and identified.",
            f"{data['record']}: accelerance, the release taken as a step force m g.",
        )
        for data in line["frequency_responses"][:1]
    )
    return [Section(f"Frequency responses{suffix}", pictures=pictures)] if pictures else []


def _records(line: dict[str, Any]) -> Grid:
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
    heads = ("Record", "Drop", "Recording", "Used after the release", "Channels")
    return Grid(heads, tuple(rows), "Records and the linear stretch used of each")


def _percent(ratio: float | None) -> str:
    return format_value(None if ratio is None else 100 * ratio, 4)
