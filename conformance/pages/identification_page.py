"""Report on an identification, from identification.json."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages import identification_figures as figures
from pantocheck.conformance.pages.damping_page import NOMINAL_INTERVALS
from pantocheck.conformance.pages.identification_figures import (
    draw_half_power,
    draw_order_search,
    draw_response_zoom,
    draw_responses,
    draw_spectra,
    draw_stretch,
)
from pantocheck.conformance.pages.record_figures import DrawnPlace, draw_drop_layout, draw_motion, draw_spectrogram
from pantocheck.conformance.pages.shape_figure import build_mode_scene, draw_shapes, list_measured_shapes, list_supports
from pantocheck.conformance.pages.words import clean_tree, format_percent, format_plain, format_value
from pantocheck.conformance.results.identification_format import (
    Comparison,
    HalfPowerLines,
    IdentifiedClock,
    IdentifiedLine,
    IdentifiedRecord,
    ModeGroup,
    OrderSearch,
    Overlay,
    RecordSpectra,
    Spectrogram,
)
from pantocheck.conformance.results.identified_modes import Mode
from pantocheck.conformance.results.motion_format import LineScene

# Fit: residual, model order and spectra.
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


# Modes: half-power bands, shapes at the sensors, table.
MODES_TEXT = (
    "Uncertainties are one standard deviation: the Cramér-Rao bound with the noise estimated from the residual, "
    "widened where the residual around a mode exceeds noise. If the line moved by itself, the bound contains this "
    "motion. Error: residual of the fit in the band of the mode, "
    "relative to the measured spectrum; by sensor in the order of modes.json."
)


def list_mode_blocks(line: IdentifiedLine, scene: int | None = None) -> Iterator[doc.Block]:
    """Explanation, figures and table of the modes of one line; `scene` is the index of its moving shapes."""
    yield doc.Paragraph(MODES_TEXT)
    yield from _half_power(line)
    if columns := list_measured_shapes(line.modes):
        groups = " and ".join(column.title for column in columns)
        figure = doc.Figure(
            draw_shapes(columns, list_supports(line.spans_m)),
            f"Real part of the mode shapes at the sensors, {groups}; each shape is scaled to its largest component. "
            "The numbers are in modes.json.",
            f"Mode shapes at the sensors, {groups}: real part over the position; vertical lines are supports.",
            curves=None if scene is None else doc.Curves("passage", scene),
            anchor="" if scene is None else f"shapes-{scene + 1}",
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
        "by sensor [%]": lambda mode: ", ".join(format_percent(sensor.error, 2) for sensor in mode.sensor_shape),
        "Warnings": lambda mode: "; ".join(mode.warnings) or "–",
    }
    return doc.make_grid("Modes by frequency", modes, cells)


# Records: places of sensors and masses, part of each record in the fit.
def list_record_blocks(line: IdentifiedLine) -> Iterator[doc.Block]:
    """Schematic and table of the records of one line of identification.json."""
    sensors, masses = _list_sensors(line.records), _list_masses(line.records)
    if line.spans_m and (sensors or masses):
        places = [
            f"{point.label} on {point.wire or 'an unknown wire'} at {format_plain(point.position_m)} m"
            for point in (*sensors, *masses)
        ]
        figure = doc.Figure(
            draw_drop_layout(line.spans_m, sensors, masses),
            f"Line with {len(line.spans_m)} spans: {'; '.join(places)}.",
            "Sensors (squares) and masses (triangles) on the line; heights and droppers are schematic.",
        )
        yield doc.Figures((figure,))
    yield _record_table(line.records)
    if line.clocks:
        stated = {None: "no statement on clocks", True: "one clock", False: "one clock each"}[line.shared_clock]
        yield _clock_table(line.clocks, stated)
    figures_of_time = [_stretch_figure(record) for record in line.records if record.residual_time_s]
    yield doc.Figures((*figures_of_time, _spectrogram_figure(line.spectrogram, line.records[0])))


def _stretch_figure(record: IdentifiedRecord) -> doc.Figure:
    start, end = (format_value(time - record.release_s, 3) for time in (record.used_from_s, record.used_to_s))
    return doc.Figure(
        draw_stretch(record),
        f"Residual of the fitted decays through the record {record.name}, over the motion at rest before the release. "
        f"The part from {start} s to {end} s after the release is used.",
        f"{record.name}: choice of the used part (shaded). Line: residual of the fitted decays in windows of 4 s, "
        "divided by the motion at rest (dashed: 1). It grows where droppers slacken or a force moves the line.",
    )


def _spectrogram_figure(data: Spectrogram, record: IdentifiedRecord) -> doc.Figure:
    start, end = (time - record.release_s for time in (record.used_from_s, record.used_to_s))
    last = max(record.length_s - record.release_s, end)
    marks = {"release": 0.0, "start of the linear decay": start, "end of the linear decay": end}
    return doc.Figure(
        draw_spectrogram(data, marks, (-record.release_s, last)),
        f"Amplitude of {data.channel} over time and frequency: whole record, and first seconds. The linear decay "
        f"lasts from {format_value(start, 3)} s to {format_value(end)} s after the release.",
        f"{data.record}: spectrogram of {data.channel}, left in windows of {data.whole.window_s:g} s, "
        f"right in windows of {data.start.window_s:g} s.",
    )


def _list_sensors(records: Sequence[IdentifiedRecord]) -> list[DrawnPlace]:
    """Sensors of all records with known positions; sensors at one place share a label."""
    names: dict[tuple[str, float], dict[str, None]] = {}
    for sensor in (sensor for record in records for sensor in record.sensors):
        if sensor.position_m is not None:
            names.setdefault((sensor.wire, sensor.position_m), {})[sensor.channel] = None
    return [DrawnPlace(", ".join(channels), wire, position) for (wire, position), channels in names.items()]


def _list_masses(records: Sequence[IdentifiedRecord]) -> list[DrawnPlace]:
    """Masses of all records with known positions; masses at one place share a label."""
    masses: dict[tuple[str, float], dict[str, None]] = {}
    for record in records:
        if record.drop_position_m is not None:
            text = "mass" if record.mass_kg is None else f"{format_plain(record.mass_kg)} kg"
            masses.setdefault((record.drop_wire, record.drop_position_m), {})[text] = None
    return [DrawnPlace(", ".join(texts), wire, position) for (wire, position), texts in masses.items()]


def _record_table(records: Sequence[IdentifiedRecord]) -> doc.Table:
    def drop(record: IdentifiedRecord) -> str:
        place = f"{record.drop_wire or '?'} at {format_plain(record.drop_position_m)} m"
        return f"{format_plain(record.mass_kg)} kg, {place}"

    def analysed(record: IdentifiedRecord) -> str:
        start, end = (time - record.release_s for time in (record.used_from_s, record.used_to_s))
        return f"{format_value(start, 3)}–{format_value(end)} s"

    cells: dict[str, Callable[[IdentifiedRecord], str]] = {
        "Record": lambda record: record.name,
        "Drop": drop,
        "Recording": lambda record: f"{format_value(record.length_s)} s at {record.sampling_rate_Hz:g} Hz",
        "Used after the release": analysed,
        "Channels": lambda record: ", ".join(record.channels),
        "First motion [s]": lambda record: ", ".join(format_value(sensor.onset_s, 4) for sensor in record.sensors),
    }
    return doc.make_grid("Records and the part of each that was used", records, cells)


def _clock_table(clocks: Sequence[IdentifiedClock], stated: str) -> doc.Table:
    cells: dict[str, Callable[[IdentifiedClock], str]] = {
        "Sensor": lambda clock: str(clock.sensor),
        "Rate [ppm]": lambda clock: f"{format_value(clock.rate_ppm, 3)} ± {format_value(clock.rate_std_ppm, 2)}",
        "Start [ms]": lambda clock: format_value(round(clock.start_ms, 6), 2),
        "Corrected": lambda clock: "yes" if clock.corrected else "no",
    }
    return doc.make_grid(f"Clocks of the sensors relative to the first one; the records state: {stated}", clocks, cells)


# Frequency responses.
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


# The whole report.
def build_identification_document(lines: Sequence[IdentifiedLine]) -> doc.Document:
    """The report on the lines of an identification."""
    lines = [clean_tree(line.rounded()) for line in lines]
    modes = [mode for line in lines for mode in line.modes]
    certain = sum(mode.certain and not mode.lateral for mode in modes)
    headline = f"{certain} modes identified with a damping ratio known to better than 5 %"
    headline += f"; {len(modes) - certain} more are uncertain or lateral." if len(modes) > certain else "."
    blocks: list[doc.Block] = [*doc.warn(collect_warnings(lines))]
    scenes: list[LineScene] = []
    for line in lines:
        names, scene = ", ".join(record.name for record in line.records), build_mode_scene(line)
        blocks += _list_sections(line, f" ({names})" if len(lines) > 1 else "", None if scene is None else len(scenes))
        scenes += [scene] if scene else []
    return replace(doc.build_plain_document("Identification of mass drops", headline, blocks), scenes=tuple(scenes))


def collect_warnings(lines: Sequence[IdentifiedLine]) -> tuple[str, ...]:
    """Warnings of all lines, each once."""
    return tuple(dict.fromkeys(text for line in lines for text in line.warnings))


def _list_sections(line: IdentifiedLine, suffix: str, scene: int | None) -> Iterator[doc.Section]:
    yield doc.Section(
        f"Damping{suffix}", (*_damping_figures(line.modes), _group_table(line.groups, UNITS[line.quantity]))
    )
    yield doc.Section(f"Modes{suffix}", tuple(list_mode_blocks(line, scene)))
    # The records stand before the fit: its tall figure starts a page, and they fill the one before.
    yield doc.Section(f"Records{suffix}", tuple(list_record_blocks(line)))
    yield doc.Section(f"Fit{suffix}", tuple(list_fit_blocks(line)))
    if motion := tuple(_list_motion_figures(line.overlays)):
        yield doc.Section(f"Motion{suffix}", (doc.Figures(motion),))
    if line.repeatability:
        yield doc.Section(f"Repeatability{suffix}", tuple(_repeatability(line)))
    if response_figures := tuple(list_response_figures(line)):
        yield doc.Section(f"Frequency responses{suffix}", (doc.Figures(response_figures),))


def _damping_figures(modes: Sequence[Mode]) -> tuple[doc.Block, ...]:
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
        "Damping ratio of every mode with its nominal 95 % interval.",
    )
    return (doc.Paragraph(NOMINAL_INTERVALS), doc.Figures((boxes, ratios)))


def _group_table(groups: Sequence[ModeGroup], unit: str) -> doc.Table:
    cells: dict[str, Callable[[ModeGroup], str]] = {
        "Group": lambda group: str(group.group),
        "Frequency [Hz]": lambda group: f"{format_value(group.from_Hz)}–{format_value(group.to_Hz)}",
        "Certain modes": lambda group: f"{group.certain} of {group.modes}",
        "Median damping ratio [%]": lambda group: format_percent(group.median_damping_ratio),
        "Range [%]": lambda group: f"{format_percent(group.lowest)} to {format_percent(group.highest)}",
    }
    if any(group.ambient_rms is not None for group in groups):
        cells[f"Ambient motion [m{unit}]"] = lambda group: _milli(group.ambient_rms)
        cells[f"Sensor noise [m{unit}]"] = lambda group: _milli(group.noise_rms)
    return doc.make_grid("Groups of span modes", groups, cells)


def _milli(value: float | None) -> str:
    return format_value(None if value is None else 1e3 * value, 2)


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
