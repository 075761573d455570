"""Report on a drop comparison, from drop_comparison.json."""

from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.drop_figures import draw_drop_motion, draw_residual_energy
from pantocheck.conformance.reports.page_text import clean_tree, format_beside_limits, format_plain, format_value

DROP_STATEMENT = "self-declared comparison with a recorded mass drop"

DROP_HEADLINES = {
    "pass": "The graded agreement of model and record lies within the limits of the user.",
    "unverified": "The graded agreement lies within the limits, but the record does not state its line completely.",
    "fail": "The agreement of model and record lies outside a limit of the user.",
    "skip": "The record does not contain all data that the limits need.",
    "info": "No limit was given: the agreement is shown and not graded.",
}
QUANTITY_NAMES = {"rms_ratio": "RMS ratio", "correlation": "Correlation"}
DROP_SCOPE = (
    "The recorded drop was simulated with the damping of each model. The limits are those of the user, not of a "
    "standard; they grade the first model. An RMS ratio is the RMS of the model over that of the record without its "
    "noise; 1 means agreement, and a dash too much noise. A small error of a frequency lowers the correlation in a "
    "late window, but not the RMS ratio. Velocities contain frequencies from 0.3 Hz only."
)


def build_drop_comparison(results: dict[str, Any]) -> doc.Document:
    """The report on the content of drop_comparison.json."""
    results = clean_tree(results)
    suite = f"Pantocheck {results['suite']['version']}"
    header = doc.VerdictHeader(
        "Mass drop: record and simulation",
        results["verdict"],
        DROP_STATEMENT,
        DROP_HEADLINES[results["verdict"]],
        f"Line: {results['line']}. Record: {results['record']} ({results['record_source']}). {suite}.",
        f"{suite} · {results['record']}",
    )
    remarks = (
        *results["warnings"],
        *(f"{name_criterion(item)} {text}" for item in results["criteria"] for text in item["close"]),
    )
    blocks: list[doc.Block] = [doc.WarningBox(remarks)] if remarks else []
    blocks += [doc.Paragraph(DROP_SCOPE), doc.Facts(_list_facts(results)), _build_model_table(results["models"])]
    if results["criteria"]:
        blocks.append(doc.Section("Criteria", (_build_criteria_table(results["criteria"]),)))
    blocks += [_build_place(place, results) for place in results["places"]]
    return doc.Document(header.heading, header, tuple(blocks))


def name_criterion(item: dict[str, Any]) -> str:
    """Criterion in words: quantity, motion, sensor, window and band."""
    return (
        f"{QUANTITY_NAMES[item['quantity']]} of the {item['motion']} at sensor {item['sensor']}, "
        f"{_format_range(item['window_s'])} s, {_format_range(item['band_Hz'])} Hz"
    )


def _format_range(pair: list[float]) -> str:
    return " to ".join(map(format_plain, pair))


def _list_facts(results: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    drop = results["drop"]
    planned = drop["planned_release_s"]
    facts = {
        "Mass": f"{format_plain(drop['mass_kg'])} kg on {drop['wire']} at {format_plain(drop['position_m'])} m",
        "Release": f"at {drop['release_s']:.4f} s of the record, where the first model fits best "
        f"(correlation {drop['release_correlation']:.4f})",
        "Planned release": None if planned is None else f"{format_plain(planned)} s",
        "Duration of the release": f"{format_plain(drop['release_duration_s'])} s",
        "Line of the record": results["line_comparison"]["state"],
        "Element length and time step": f"{format_plain(results['element_m'])} m, "
        f"{format_plain(results['time_step_s'])} s",
        "Digest of the line": results["line_digest"],
        "Digest of the record": results["record_digest"],
        "Digest of the suite": results["suite"]["digest"],
    }
    return tuple((name, text) for name, text in facts.items() if text)


def _build_model_table(models: list[dict[str, Any]]) -> doc.Table:
    columns = (
        doc.Column("Model"),
        doc.Column("Source", share=1),
        doc.Column("Last slack dropper [s]", number=True),
    )
    rows = tuple((model["name"], model["source"], format_value(model["last_slack_s"], 3)) for model in models)
    return doc.Table(columns, rows, "Damping models")


def _build_criteria_table(criteria: list[dict[str, Any]]) -> doc.Table:
    columns = (
        doc.Column("Criterion", share=3),
        doc.Column("Value", number=True),
        doc.Column("Limits", number=True),
        doc.Column("± model", number=True),
        doc.Column("± noise", number=True),
        doc.Column("Verdict"),
        doc.Column("Remark", share=2),
    )
    rows: list[tuple[doc.RichText, ...]] = []
    for item in criteria:
        value, bounds = format_beside_limits(item["value"], item["lower"], item["upper"])
        errors = format_value(item["discretisation"], 2), format_value(item["measurement"], 2)
        verdict = doc.VerdictMark(item["verdict"])
        rows.append((name_criterion(item), value, bounds, *errors, verdict, item["reason"] or "–"))
    return doc.Table(columns, tuple(rows))


def _build_place(place: dict[str, Any], results: dict[str, Any]) -> doc.Section:
    """Section of a sensor or of the mass: motion in every window, residual energy, table of all bands."""
    name = place["name"]
    where = f"{place['wire']} at {format_plain(place['position_m'])} m"
    curves = [curve for curve in results["curves"] if curve["place"] == name]
    energy = next(item for item in results["energies"] if item["place"] == name)
    graded = results["models"][0]["name"]
    figures = [
        doc.Figure(
            draw_drop_motion([curve for curve in curves if curve["window_s"] == window]),
            f"Velocity and acceleration of {name}, {_format_range(window)} s after the release.",
            f"Velocity and acceleration of {name} up to 20 Hz, {_format_range(window)} s after the release.",
        )
        for window in results["windows_s"]
    ]
    figures.append(
        doc.Figure(
            draw_residual_energy(energy, graded),
            f"Mean square of the velocity of {name} against time.",
            f"Residual energy of {name}: mean square of the velocity up to 20 Hz in windows of two seconds.",
        )
    )
    rows = [row for row in results["statistics"] if row["place"] == name]
    heading = f"Mass, {where}" if place["sensor"] is None else f"{name}, {where}"
    return doc.Section(heading, (doc.Figures(tuple(figures)), _build_statistics_table(rows)))


def _build_statistics_table(rows: list[dict[str, Any]]) -> doc.Table:
    """RMS, ratio and correlation of each model; one row per motion, window, band and model."""
    records = [{**row, **model} for row in rows for model in row["models"]]
    cells = {
        "Motion": lambda row: row["motion"],
        "Window [s]": lambda row: _format_range(row["window_s"]),
        "Band [Hz]": lambda row: _format_range(row["band_Hz"]),
        "Record": lambda row: format_value(row["record_rms"]),
        "Noise": lambda row: format_value(row["noise_rms"], 2),
        "Model": lambda row: format_value(row["rms"]),
        "Ratio": lambda row: format_value(row["rms_ratio"]),
        "Correlation": lambda row: format_value(row["correlation"]),
        "Damping": lambda row: row["model"],
    }
    return doc.make_grid("RMS of record, noise and model [m/s, m/s²]; ratio and correlation", records, cells)
