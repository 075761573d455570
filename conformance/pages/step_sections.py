"""Sections of the steps of a procedure: verdict, criteria, figures and tables."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from pantocheck.conformance.core.figure_data import Chart, Mark, Series
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.comparison_parts import list_remarks
from pantocheck.conformance.pages.criteria_table import criteria_blocks
from pantocheck.conformance.pages.pantograph_pages import build_response_sections
from pantocheck.conformance.pages.scope_page import format_claimed, mark_step, name_claim, name_step, step_anchor
from pantocheck.conformance.pages.static_sections import build_static_sections
from pantocheck.conformance.pages.study_chart import draw_chart
from pantocheck.conformance.pages.words import (
    format_plain,
    format_signed,
    format_value,
    name_pantograph,
    quantity_label,
    quantity_unit,
)
from pantocheck.conformance.quantities.limit_text import is_relative_margin
from pantocheck.conformance.results.case_facts_format import MeasuredRun
from pantocheck.conformance.results.comparison_format import ModelComparison
from pantocheck.conformance.results.procedure_format import (
    Evidence,
    JoinedQuantity,
    Procedure,
    ProcedureStep,
    StepName,
    ValidityClaim,
)
from pantocheck.conformance.results.results_format import CaseResult

Compared = TypeVar("Compared", bound=ModelComparison)

SHORT_STEPS = ("simulation_parameters", "limits_of_validity")
"""Steps that need no page of their own."""

MOST_NUMBERED = 12
"""Largest number of runs that are all numbered along an axis."""

SPREAD_QUANTITY = "std_force_N"
"""Quantity of the figure that joins the line tests."""


def build_step_section(
    number: int, step: ProcedureStep, procedure: Procedure, cases: Sequence[CaseResult], index: tuple[doc.Table, ...]
) -> doc.Section:
    """Section of one step; the sections of its cases follow it.

    Args:
        number: Number of the step in the order of the procedure, from 1.
        step: The step.
        procedure: Its procedure, with prepared texts.
        cases: Cases of the run.
        index: List of the cases of the step; empty if it has none.
    """
    word = f"\N{EN SPACE}{step.reason or step.unconfirmed or ''}"
    blocks: list[doc.Block] = [doc.Paragraph((doc.VerdictMark(mark_step(step, cases)), word))]
    if step.criteria:
        anchor = step_anchor(step)
        blocks.append(doc.Section("Criteria", criteria_blocks(step.criteria, anchor, f"{anchor}-source")))
    blocks += index
    if step.step in BUILDERS:
        blocks += BUILDERS[step.step](procedure, cases)
    if step.notes:
        blocks.append(doc.BulletList(tuple(step.notes)))
    return doc.Section(
        f"{number} {name_step(step)}", tuple(blocks), anchor=step_anchor(step), ruled=step.step not in SHORT_STEPS
    )


def _comparison_blocks(
    comparisons: Sequence[Compared], build: Callable[[Compared], Sequence[doc.Block]]
) -> tuple[doc.Block, ...]:
    """Section of each comparison of a model with measured values."""
    return tuple(doc.Section(one.model.name, (*doc.warn(list_remarks(one)), *build(one))) for one in comparisons)


def _parameter_blocks(procedure: Procedure, cases: Sequence[CaseResult]) -> tuple[doc.Block, ...]:
    if not procedure.parameters:
        return ()
    table = doc.make_table(
        procedure.parameters,
        {
            doc.Column("Parameter", 2): lambda parameter: quantity_label(parameter.name),
            doc.Column("Declared", 3): lambda parameter: parameter.declared,
            doc.Column("Runs", 3): lambda parameter: parameter.runs,
            doc.Column("Confirmed"): lambda parameter: "yes" if parameter.confirmed else "no",
        },
    )
    return (doc.Section("Declared parameters and those of the runs", (table,)),)


def _reference_blocks(procedure: Procedure, cases: Sequence[CaseResult]) -> tuple[doc.Block, ...]:
    """Margins by limits that count, case by case."""
    listed = _find_step(procedure, "reference_models").cases
    shown = [case for case in cases if case.id in listed]
    points = [
        (place, row.margin)
        for place, case in enumerate(shown)
        for row in case.criteria
        if row.verdict in ("pass", "fail") and row.margin is not None and row.lower != row.upper
        if is_relative_margin(row.lower, row.upper)
    ]
    if not points:
        return ()
    caption = "Margins by limits that count, case by case in the order of the list: 1 in the middle, 0 on a limit."
    series = Series(label="criterion", style="points", x=[x for x, _ in points], y=[margin for _, margin in points])
    limit = Mark(label="limit", axis="y", low=0.0)
    chart = _chart(caption, ("case", "margin [-]"), len(shown), [series], [limit])
    return (doc.Figures((doc.Figure(draw_chart(chart), f"{caption} The tables have the values.", caption),)),)


def _line_test_blocks(procedure: Procedure, cases: Sequence[CaseResult]) -> tuple[doc.Block, ...]:
    blocks: list[doc.Block] = []
    shown = [case for case in cases if case.id in _find_step(procedure, "line_test").cases]
    compared = [case for case in shown if case.comparison]
    if compared:
        blocks.append(doc.Figures((_draw_pairs(compared),)))
    if joined := procedure.joined:
        blocks.append(doc.Section("Joined over the pairs", (_build_joined_table(joined),)))
    return tuple(blocks)


def _draw_pairs(cases: Sequence[CaseResult]) -> doc.Figure:
    """Standard deviation of the force in every pair, simulated and measured, with both uncertainties."""
    series = []
    runs: dict[str, Sequence[CaseResult | MeasuredRun]] = {
        "simulated": cases,
        "measured": [case.comparison for case in cases if case.comparison],
    }
    for label, parts in runs.items():
        points = [
            (place, value, part.uncertainty.get(key, {}).get(SPREAD_QUANTITY) or 0.0)
            for place, part in enumerate(parts)
            for key, values in part.quantities.items()
            if (value := values.get(SPREAD_QUANTITY)) is not None
        ]
        x, y, error = ([point[part] for point in points] for part in range(3))
        series.append(Series(label=label, style="points", x=x, y=y, error=error))
    caption = (
        f"{quantity_label(SPREAD_QUANTITY)} in all compared pairs, in the order of the list, with both uncertainties."
    )
    chart = _chart(caption, ("pair", "standard deviation [N]"), len(cases), series)
    return doc.Figure(draw_chart(chart), f"{caption} The table has the differences.", caption)


def _number(count: int) -> list[str]:
    """Numbers along an axis; of many, every fifth."""
    return [str(n) if count <= MOST_NUMBERED or n % 5 == 0 else "" for n in range(1, count + 1)]


def _chart(
    caption: str, labels: tuple[str, str], count: int, series: list[Series], marks: Sequence[Mark] = ()
) -> Chart:
    """Chart with the numbers of `count` runs along the horizontal axis."""
    return Chart(
        caption=caption,
        alternative=caption,
        x_label=labels[0],
        y_label=labels[1],
        ticks=_number(count),
        series=series,
        marks=list(marks),
    )


def _build_joined_table(joined: Sequence[JoinedQuantity]) -> doc.Table:
    return doc.make_table(
        joined,
        {
            doc.Column("Quantity", share=2): lambda item: quantity_label(item.quantity),
            doc.Column("Owner"): lambda item: name_pantograph(item.pantograph),
            doc.Column("Pairs", number=True): lambda item: str(item.runs),
            doc.Column("Mean difference", number=True): lambda item: format_signed(item.mean_difference),
            doc.Column("±", number=True): lambda item: format_value(item.uncertainty, 2),
            doc.Column("Spread", number=True): lambda item: format_value(item.spread, 2),
            doc.Column("Largest", number=True): lambda item: format_signed(item.largest_difference),
            doc.Column("Unit"): lambda item: quantity_unit(item.quantity),
            doc.Column("Largest in", share=1): lambda item: item.largest_in.removeprefix("pair/"),
        },
        "Simulated minus measured value, all pairs",
    )


def _validity_blocks(procedure: Procedure, cases: Sequence[CaseResult]) -> tuple[doc.Block, ...]:
    claims, evidence = procedure.claims, procedure.evidence
    if not claims:
        return ()
    table = doc.make_table(
        claims,
        {
            doc.Column("Claim", 2): name_claim,
            doc.Column("Claimed", 2): lambda claim: format_claimed(claim.claimed, claim.unit),
            doc.Column("Shown by runs", 2): lambda claim: format_claimed(claim.verified, claim.unit),
            doc.Column("Verdict"): lambda claim: doc.VerdictMark(claim.verdict),
            doc.Column("Runs or reason", 4): lambda claim: claim.reason or ", ".join(claim.evidence),
        },
    )
    blocks: list[doc.Block] = [table]
    if evidence:
        blocks += [doc.Figures((_draw_evidence(claims, evidence),)), _build_evidence_table(evidence)]
    return tuple(blocks)


def _draw_evidence(claims: Sequence[ValidityClaim], evidence: Sequence[Evidence]) -> doc.Figure:
    """Speeds of all runs, with the claimed range. A run on a line without a claim is not evidence for the speeds."""
    lines = {claim.name for claim in claims if claim.kind == "line"}
    labels = [_label_run(item, lines) for item in evidence]
    series = [
        Series(
            label=label,
            style="points",
            x=[place for place, other in enumerate(labels) if other == label],
            y=[item.speed_km_h for item, other in zip(evidence, labels, strict=True) if other == label],
        )
        for label in RUN_LABELS
        if label in labels
    ]
    marks = [
        Mark(label="claimed speeds", axis="y", low=claim.claimed[0], high=claim.claimed[1])
        for claim in claims
        if claim.kind == "speed" and claim.claimed is not None
    ]
    caption = "Speeds of the runs, numbered as in the table, and the claimed range."
    chart = _chart(caption, ("run", "speed [km/h]"), len(evidence), series, marks)
    return doc.Figure(draw_chart(chart), f"{caption} The table has the values.", caption)


RUN_LABELS = ("passed", "not passed", "another line")
"""Labels of the runs in the figure of the speeds."""


def _label_run(item: Evidence, lines: set[str]) -> str:
    if lines and item.line not in lines:
        return "another line"
    return "passed" if item.passed else "not passed"


def _build_evidence_table(evidence: Sequence[Evidence]) -> doc.Table:
    return doc.make_table(
        enumerate(evidence, 1),
        {
            doc.Column("No.", number=True): lambda row: str(row[0]),
            doc.Column("Run", 2): lambda row: row[1].id,
            doc.Column("Passed"): lambda row: "yes" if row[1].passed else "no",
            doc.Column("Speed [km/h]", number=True): lambda row: format_plain(row[1].speed_km_h),
            doc.Column("Spacing [m]", number=True): lambda row: ", ".join(map(format_plain, row[1].spacing_m)) or "–",
            doc.Column("Line", 2): lambda row: row[1].line,
            doc.Column("Pantographs", 2): lambda row: ", ".join(row[1].pantographs),
            doc.Column("Inputs", 2): lambda row: (
                ", ".join(f"{key}: {format_plain(value)}" for key, value in row[1].inputs.items()) or "–"
            ),
        },
        "Conditions of the runs",
    )


def _find_step(procedure: Procedure, name: str) -> ProcedureStep:
    return next(step for step in procedure.steps if step.step == name)


BUILDERS: dict[StepName, Callable[[Procedure, Sequence[CaseResult]], tuple[doc.Block, ...]]] = {
    "pantograph_model": lambda procedure, cases: _comparison_blocks(procedure.responses, build_response_sections),
    "static_check": lambda procedure, cases: _comparison_blocks(procedure.statics, build_static_sections),
    "simulation_parameters": _parameter_blocks,
    "reference_models": _reference_blocks,
    "line_test": _line_test_blocks,
    "limits_of_validity": _validity_blocks,
}
"""Builder of the blocks of a step, below its criteria and cases."""
