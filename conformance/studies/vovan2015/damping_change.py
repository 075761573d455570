"""Change of the contact force by another damping model, band by band (Vo Van, Balmes and Lorang 2015, Table 1)."""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.quantities.signals import EXTENDED_CUTOFF_HZ, ForceChannel
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.figure_data import Chart, Series, TextTable
from pantocheck.conformance.results.outcome import (
    Delivered,
    Errored,
    Outcome,
    Skipped,
    StudyResult,
    missing_record_reason,
)
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.studies.band_charts import PrintedValues, draw_band_bars, list_pantographs
from pantocheck.conformance.studies.vovan2015.paper_tables import build_findings_table, build_provenance_table
from pantocheck.conformance.systems.system import System

PRINTED_QUANTITIES = ("cov_20", "cov_50", *BAND_QUANTITIES)


def run_damping_change(case: Case, study: DampingChange, system: System) -> Outcome:
    """Run a passage with the earlier damping and with that of the case, and compare the bands.

    Parameters
    ----------
    case : Case
        Passage with the damping after the change.
    study : DampingChange
        Damping before the change, and printed values.
    system : System
        System under test, which runs both passages.

    Returns
    -------
    Outcome
        Delivered run with the damping of the case and the comparison; else the reason of the run without a record.
    """
    ((name, damping),) = case.dampings.items()
    runs: dict[str, Delivered] = {}
    records: dict[str, Record] = {}
    for model, variant in ((name, case.with_damping(name, damping)), (study.after, case.without_study())):
        outcome = system.run(variant)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            failure = Skipped if isinstance(outcome, Skipped) else Errored
            return failure(f"{model}: {missing_record_reason(outcome)}")
        runs[model], records[model] = outcome, outcome.record
    before, after = runs.values()
    values = {model: _evaluate(case, record) for model, record in records.items()}
    findings = band_changes(*values.values())
    printed = {(table.model, table.pantograph): table.values for table in study.printed}
    printed_changes = band_changes(
        *({p: dict(table) for (model, p), table in printed.items() if model == run} for run in runs)
    )
    return replace(
        after,
        refined=_compare_runs(case, before.refined, after.refined),
        coarse=_compare_runs(case, before.coarse, after.coarse),
        starts=tuple(_add_changes(case, *pair) for pair in zip(before.starts, after.starts, strict=True)),
        study=StudyResult(
            findings=findings,
            charts=(*draw_band_bars(values, printed, BAND_QUANTITIES), *_draw_rear_force(case, study.span, records)),
            tables=(
                build_findings_table(case.limits, findings, printed_changes),
                _comparison_table(values, printed),
                build_provenance_table(case),
            ),
        ),
    )


def _compare_runs(case: Case, before: Delivered | None, after: Delivered | None) -> Delivered | None:
    """Run after the change with the changes of the bands; None if one of the runs is missing."""
    return None if before is None or after is None else _add_changes(case, before, after)


def _add_changes(case: Case, before: Delivered, after: Delivered) -> Delivered:
    """Run after the change with the changes of the bands."""
    changes = band_changes(_evaluate(case, before.record), _evaluate(case, after.record))
    return replace(after, study=StudyResult(changes))


def band_changes(before: ValuesByOwner, after: ValuesByOwner) -> dict[int, dict[str, Value]]:
    """Changes of the RMS in the bands [%].

    Parameters
    ----------
    before, after : ValuesByOwner
        Quantities by pantograph and name.

    Returns
    -------
    dict of int to dict of str to Value
        Changes by pantograph and name, without the bands that one side lacks. The line holds the difference of the
        last and the first pantograph.
    """
    findings: dict[int, dict[str, Value]] = {}
    for pantograph in before.keys() & after.keys() - {LINE}:
        findings[pantograph] = {}
        for band in BAND_QUANTITIES:
            old, new = before[pantograph].get(band), after[pantograph].get(band)
            if isinstance(old, float) and isinstance(new, float) and old > 0:
                findings[pantograph][f"change_{band.removesuffix('_N')}_pct"] = 100 * (new / old - 1)
    last, highest_band = max(findings, default=1), "change_rms_20_50_pct"
    rear, front = (findings.get(pantograph, {}).get(highest_band) for pantograph in (last, 1))
    if last > 1 and isinstance(rear, float) and isinstance(front, float):
        findings[LINE] = {"rear_over_front_change_20_50_pct": rear - front}
    return findings


def _evaluate(case: Case, record: Record | None) -> ValuesByOwner:
    if record is None:
        return {}
    return evaluate_record(record, case.file.filter.low_pass, case.line.geometry.supports).values


def _comparison_table(values: Mapping[str, ValuesByOwner], printed: PrintedValues) -> TextTable:
    pantographs = list_pantographs(values)
    rows = []
    for quantity in PRINTED_QUANTITIES:
        for model, computed in values.items():
            sources = [source for p in pantographs for source in (computed.get(p, {}), printed.get((model, p), {}))]
            numbers = [source.get(quantity) for source in sources]
            cells = [f"{number:.3g}" if isinstance(number, int | float) else "-" for number in numbers]
            rows.append([quantity, model, *cells])
    heads = [f"{origin}, pantograph {p}" for p in pantographs for origin in ("computed", "printed")]
    return TextTable(
        caption="Computed and printed values. Line and pantograph are assumed: absolute values are informative.",
        columns=["Quantity", "Damping", *heads],
        rows=rows,
    )


def _draw_rear_force(case: Case, span: int, records: Mapping[str, Record]) -> list[Chart]:
    """Contact force of the last pantograph over one span, low-passed at 20 Hz and at 50 Hz (Figure 11 of the paper)."""
    start, end = case.line.geometry.span(span)
    charts = []
    for cutoff in (case.file.filter.cutoff_Hz, EXTENDED_CUTOFF_HZ):
        low_pass = replace(case.file.filter.low_pass, cutoff_Hz=cutoff)
        series = []
        for model, record in records.items():
            try:
                force = ForceChannel(record.force[-1], record.rate, low_pass, record.filter_applied_Hz).graded
            except QuantityUnavailable:
                continue
            position = record.position[-1]
            inside = (position >= start) & (position <= end)
            series.append(
                Series(label=model, style="line", x=thin_series(position[inside]), y=thin_series(force[inside]))
            )
        if series:
            charts.append(
                Chart(
                    caption=f"Contact force of the last pantograph, span {span}, low-passed at {cutoff:g} Hz.",
                    alternative=f"Contact force from {start:g} m to {end:g} m under the two damping models.",
                    x_label="position along the track [m]",
                    y_label="contact force [N]",
                    series=series,
                )
            )
    return charts
