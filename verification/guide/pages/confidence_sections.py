"""Sections on uncertainty, self-test, performance and known limitations."""

from statistics import median
from typing import Any

from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.words import format_percent, format_value

CONTAINMENT_SCOPE = (
    "The half-width of the discretisation of each value follows from three meshes. It should contain the difference "
    "between the value and the extrapolated solution, which was computed with finer meshes and is stored with the "
    "case. This version tunes the uplift forces again: a change of the mean contact force within the tolerance of the "
    "tuning (0.02 N) counts as an error here. The page on uncertainty describes the calibration of the other "
    "components."
)

SELF_TEST_SCOPE = (
    "Systems with one known fault each must not pass. Faults of records are found by the checks of a record or by the "
    "limits; numerical faults by the verification up to 50 Hz. Faults marked optional are small and show the limit of "
    "detection."
)

TIMING_SCOPE = (
    "Process time of one passage with its set-up, after compilation, alone on this machine; the better of two."
)


def build_uncertainty_section(library: list[dict[str, Any]]) -> doc.Section:
    """Section on the containment of the extrapolated solutions."""
    cases = [(case["case"], _list_contained(case)) for case in library]
    counted = [(name, ratios) for name, ratios in cases if ratios]
    every = [ratio for _, ratios in counted for ratio in ratios]
    contained = sum(ratio <= 1 for ratio in every)
    summary = (
        f"{contained} of {len(every)} differences lie within their half-width "
        f"({format_percent(contained / len(every), 3)} %; target 95 %)."
        if every
        else "No case has an extrapolated solution."
    )
    columns = (
        doc.Column("Case", share=2.0),
        doc.Column("Values", number=True),
        doc.Column("Contained", number=True),
        doc.Column("Median ratio", number=True),
        doc.Column("Largest ratio", number=True),
    )
    rows = tuple(
        (
            name,
            str(len(ratios)),
            str(sum(ratio <= 1 for ratio in ratios)),
            format_value(median(ratios), 2),
            format_value(max(ratios), 2),
        )
        for name, ratios in counted
    )
    caption = "Ratio of the difference to the half-width"
    return doc.Section(
        "Uncertainty",
        (doc.Paragraph(CONTAINMENT_SCOPE), doc.Paragraph(summary), doc.Table(columns, rows, caption, layout="grid")),
        anchor="uncertainty",
    )


def _list_contained(case: dict[str, Any]) -> list[float]:
    """Ratios of the difference from the extrapolated value to the half-width of the discretisation."""
    return [
        abs(row["value"] - row["first"]) / row["discretisation"] for row in case["converged"] if row["discretisation"]
    ]


def build_self_test_section(self_test: dict[str, Any] | None) -> tuple[doc.Section, ...]:
    """Section on the self-test; none if it failed."""
    if self_test is None:
        return ()
    records, numerical = self_test["records"], self_test["numerical"]
    unchanged = ", ".join(f"{name}: {verdict}" for name, verdict in self_test["reference"].items())
    summary = (
        f"{_count_detected(records)} faults of records and {_count_detected(numerical)} numerical faults that must be "
        f"detected are detected. The unchanged simulator: {unchanged}."
    )
    tables = (
        _build_fault_table("Faults of records", records),
        _build_fault_table("Numerical faults, by the verification up to 50 Hz", numerical),
    )
    blocks = (doc.Paragraph(SELF_TEST_SCOPE), doc.Paragraph(summary), *tables)
    return (doc.Section("Self-test", blocks, anchor="self-test"),)


def _count_detected(faults: list[dict[str, Any]]) -> str:
    required = [fault for fault in faults if fault["must_be_detected"]]
    return f"{sum(fault['detected'] for fault in required)} of {len(required)}"


def _build_fault_table(caption: str, faults: list[dict[str, Any]]) -> doc.Table:
    columns = (
        doc.Column("Fault", share=2.0),
        doc.Column("Case", share=2.0),
        doc.Column("Verdict"),
        doc.Column("Detected by", share=2.0),
    )
    rows = tuple(
        (
            fault["name"] if fault["must_be_detected"] else f"{fault['name']} (optional)",
            fault["case"],
            doc.VerdictMark(fault["verdict"]),
            fault["detected_by"] or "–",
        )
        for fault in faults
    )
    return doc.Table(columns, rows, caption)


def build_performance_section(performance: dict[str, Any] | None) -> tuple[doc.Section, ...]:
    """Section on the computing times; none if the measurement failed."""
    if performance is None:
        return ()
    columns = (
        doc.Column("Case", share=2.0),
        doc.Column("Pantographs", number=True),
        doc.Column("Simulated [s]", number=True),
        doc.Column("Process time [s]", number=True),
        doc.Column("Ratio", number=True),
    )
    rows = tuple(
        (
            row["case"],
            str(row["pantographs"]),
            format_value(row["simulated_s"], 3),
            format_value(row["process_s"], 3),
            format_value(row["ratio"], 2),
        )
        for row in performance["timings"]
    )
    machine = f"Machine: {performance['processor']}, {performance['cores']} cores."
    blocks = (doc.Paragraph(TIMING_SCOPE), doc.Paragraph(machine), doc.Table(columns, rows, layout="grid"))
    return (doc.Section("Performance", blocks, anchor="performance"),)


def mark_code(text: str) -> doc.RichText:
    """Text in which names between grave accents stand in typewriter letters."""
    pieces = text.split("`")
    return tuple(doc.Code(piece) if number % 2 else piece for number, piece in enumerate(pieces) if piece)


def build_limitations_section(limitations: list[dict[str, Any]]) -> doc.Section:
    """Section on the known limitations."""
    parts = tuple(
        doc.Section(part["title"], (doc.BulletList(tuple(map(mark_code, part["sentences"]))),)) for part in limitations
    )
    return doc.Section("Known limitations", parts, anchor="limitations")
