"""Report on a response comparison, from response_comparison.json."""

from typing import Any

from pantocheck.conformance.reports import document as doc
from pantocheck.conformance.reports.figures.response_figure import draw_response
from pantocheck.conformance.reports.page_text import clean_tree, format_beside_limits, format_plain, format_value
from pantocheck.conformance.reports.words import quantity_label

RESPONSE_STATEMENT = "self-declared comparison with measured frequency responses"

RESPONSE_HEADLINES = {
    "pass": "The graded deviations of the pantograph model lie within the limits of the user.",
    "fail": "A deviation of the pantograph model exceeds a limit of the user.",
    "skip": "The responses do not contain all data that the limits need.",
    "info": "No limit was given: the deviations are shown and not graded.",
}
RESPONSE_SCOPE = (
    "Response of the pantograph model at the centre of its head, with a fixed base, beside measured responses. The "
    "limits are those of the user, not of a standard. The model is linear: friction and stops have no part in it, and "
    "static force and height do not change its response. A deviation is the logarithm of the dynamic stiffness of the "
    "model over the measured one: its real part is the relative deviation of the modulus, its imaginary part that of "
    "the phase, and the complex deviation joins both. It has the same size for every kind of response. Responses at "
    "single contact strips are informative. The records are unverified: a frequency response has no second channel "
    "that could confirm it."
)


def build_response_comparison(results: dict[str, Any]) -> doc.Document:
    """The report on the content of response_comparison.json."""
    results = clean_tree(results)
    suite = f"Pantocheck {results['suite']['version']}"
    header = doc.VerdictHeader(
        "Pantograph: measured response and model",
        results["verdict"],
        RESPONSE_STATEMENT,
        RESPONSE_HEADLINES[results["verdict"]],
        f"Pantograph: {results['pantograph']}. {_count_responses(results)}. {suite}.",
        f"{suite} · {results['pantograph']}",
    )
    facts = (
        ("Digest of the pantograph", results["pantograph_digest"]),
        ("Digest of the suite", results["suite"]["digest"]),
    )
    remarks = tuple(list_response_remarks(results))
    blocks: list[doc.Block] = [doc.WarningBox(remarks)] if remarks else []
    blocks += [doc.Paragraph(RESPONSE_SCOPE), *build_response_blocks(results), doc.Facts(facts)]
    return doc.Document(header.heading, header, tuple(blocks))


def build_response_blocks(results: dict[str, Any]) -> tuple[doc.Block, ...]:
    """Criteria, and a section of each response; `results` is the content of response_comparison.json."""
    criteria = results["criteria"]
    graded = (doc.Section("Criteria", (_build_criteria_table(criteria),)),) if criteria else ()
    return (*graded, *build_response_sections(results))


def build_response_sections(results: dict[str, Any]) -> tuple[doc.Section, ...]:
    """Section of each response, with its figure and its bands."""
    return tuple(_build_response_section(response, results["criteria"]) for response in results["responses"])


def list_response_remarks(results: dict[str, Any]) -> list[str]:
    """Caveats of response_comparison.json: its warnings, and criteria close to their limit."""
    close = (f"{name_response_criterion(item)} {text}" for item in results["criteria"] for text in item["close"])
    return [*results["warnings"], *close]


def name_response_criterion(item: dict[str, Any]) -> str:
    """Criterion in words: deviation, band, static force and height."""
    height = "" if item["height_m"] is None else f", {format_plain(item['height_m'])} m"
    return (
        f"{quantity_label(item['quantity'])}, {_format_band(item['band_Hz'])} Hz, "
        f"{format_plain(item['static_force_N'])} N{height} [{item['unit']}]"
    )


def _count_responses(results: dict[str, Any]) -> str:
    count = len(results["responses"])
    return f"{count} measured response{'s' if count > 1 else ''}"


def _format_band(band: list[float]) -> str:
    return " to ".join(map(format_plain, band))


def _build_criteria_table(criteria: list[dict[str, Any]]) -> doc.Table:
    columns = (
        doc.Column("Criterion", share=3),
        doc.Column("Value", number=True),
        doc.Column("Limit", number=True),
        doc.Column("± measured", number=True),
        doc.Column("Verdict"),
        doc.Column("Source", share=1),
        doc.Column("Remark", share=2),
    )
    rows: list[tuple[doc.RichText, ...]] = []
    for item in criteria:
        value, bounds = format_beside_limits(item["value"], None, item["upper"])
        measurement = "not stated" if item["measurement"] is None else format_value(item["measurement"], 2)
        verdict = doc.VerdictMark(item["verdict"])
        name, remark = name_response_criterion(item), item["reason"] or "–"
        rows.append((name, value, bounds, measurement, verdict, item["source"], remark))
    return doc.Table(columns, tuple(rows))


def _build_response_section(response: dict[str, Any], criteria: list[dict[str, Any]]) -> doc.Section:
    limits = [
        item
        for item in criteria
        if item["response"] == response["name"] and item["quantity"] == "complex_deviation_pct"
    ]
    kind = response["kind"].replace("_", " ")
    figure = doc.Figure(
        draw_response(response, limits),
        f"Modulus and phase of the {kind} of {response['name']}, measured and of the model, and their deviation.",
        f"{response['name']}: {kind} at the head, measured and of the model, and the deviation of the model.",
    )
    blocks = (doc.Figures((figure,)), _build_band_table(response["bands"]), doc.Facts(_list_facts(response)))
    return doc.Section(_name_response(response), blocks)


def _name_response(response: dict[str, Any]) -> str:
    height = "" if response["height_m"] is None else f", {format_plain(response['height_m'])} m"
    informative = "" if response["is_graded"] else " (informative)"
    return f"{response['name']}: {format_plain(response['static_force_N'])} N{height}{informative}"


def _list_facts(response: dict[str, Any]) -> tuple[tuple[str, str], ...]:
    points = [response[key].replace("_", " ") for key in ("excited_at", "measured_at")]
    facts = {
        "Source": response["source"],
        "Force and motion": f"{points[0]} and {points[1]}",
        "Measured values": str(len(response["row"])),
        "Digest of the record": response["digest"],
        "Note": response["note"],
    }
    return tuple((name, text) for name, text in facts.items() if text)


def _build_band_table(bands: list[dict[str, Any]]) -> doc.Table:
    """RMS and largest deviations of each band."""

    def value(key: str, band: dict[str, Any]) -> str:
        deviation, error = (band[part].get(key) for part in ("deviations", "uncertainty"))
        return format_value(deviation, 3) + ("" if error is None else f" ± {format_value(error, 2)}")

    def largest(key: str, place: str, band: dict[str, Any]) -> str:
        at = band[place]
        return "–" if at is None else f"{format_value(band['deviations'][key], 3)} at {format_value(at, 3)} Hz"

    cells = {
        "Band [Hz]": lambda band: _format_band(band["band_Hz"]),
        "Values": lambda band: str(band["rows"]),
        "Modulus [%]": lambda band: value("modulus_deviation_pct", band),
        "Phase [°]": lambda band: value("phase_deviation_deg", band),
        "Complex [%]": lambda band: value("complex_deviation_pct", band),
        "Largest, modulus [%]": lambda band: largest("largest_modulus_deviation_pct", "largest_modulus_at_Hz", band),
        "Largest, phase [°]": lambda band: largest("largest_phase_deviation_deg", "largest_phase_at_Hz", band),
        "Beyond uncertainty [%]": lambda band: format_value(band["beyond_uncertainty_pct"], 3),
        "Missing": lambda band: band["missing"] or "–",
    }
    return doc.make_grid("RMS and largest deviations by band", bands, cells)
