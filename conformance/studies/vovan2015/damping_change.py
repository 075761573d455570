"""Change of the contact force by another damping model, band by band (Vo Van, Balmes and Lorang 2015, Table 1)."""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.force_signals import EXTENDED_CUTOFF_HZ, ForceChannel
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.results.figure_data import Chart, Series
from pantocheck.conformance.results.outcome import (
    Delivered,
    Errored,
    Outcome,
    Skipped,
    StudyResult,
    missing_record_reason,
)
from pantocheck.conformance.results.traces import thin_series
from pantocheck.conformance.studies.band_charts import draw_band_bars
from pantocheck.conformance.studies.vovan2015.change_tables import build_changes_table, build_values_table
from pantocheck.conformance.studies.vovan2015.force_changes import ForceChanges, compare_damping_runs, force_changes
from pantocheck.conformance.studies.vovan2015.paper_tables import build_findings_table, build_provenance_table
from pantocheck.conformance.systems.system import System


def run_damping_change(case: Case, study: DampingChange, system: System) -> Outcome:
    """Run a passage with the earlier damping and with that of the case, and compare the bands.

    Args:
        case: Passage with the damping after the change.
        study: Damping before the change, and printed values.
        system: System under test, which runs both passages.

    Returns:
        Delivered run with the damping of the case and the comparison; else the reason of the run without a record.
    """
    ((name, damping),) = case.dampings.items()
    runs: dict[str, Delivered] = {}
    signals: dict[str, RecordSignals] = {}
    for model, variant in ((name, case.with_damping(name, damping)), (study.after, case.without_study())):
        outcome = system.run(variant)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            failure = Skipped if isinstance(outcome, Skipped) else Errored
            return failure(f"{model}: {missing_record_reason(outcome)}")
        runs[model], signals[model] = outcome, _build_signals(case, outcome.record)
    before, after = runs.values()
    changes = compare_damping_runs(signals[name], signals[study.after], case.shifted_sections)
    return replace(
        after,
        refined=_compare_runs(case, before.refined, after.refined),
        coarse=_compare_runs(case, before.coarse, after.coarse),
        starts=tuple(_add_changes(case, *pair) for pair in zip(before.starts, after.starts, strict=True)),
        study=_build_study(case, study, signals, changes),
    )


def _build_study(
    case: Case, study: DampingChange, signals: Mapping[str, RecordSignals], changes: ForceChanges
) -> StudyResult:
    """Findings, figures and tables of the two runs."""
    values = {model: run.evaluation.values for model, run in signals.items()}
    printed = {(table.model, table.pantograph): table.values for table in study.printed}
    printed_changes = force_changes(
        *({p: dict(table) for (model, p), table in printed.items() if model == run} for run in signals)
    )
    return StudyResult(
        findings=changes.values,
        spread=changes.spread,
        charts=(*draw_band_bars(values, printed, BAND_QUANTITIES), *_draw_rear_force(case, study.span, signals)),
        tables=(
            build_findings_table(case.limits, changes.values, printed_changes),
            build_changes_table(changes, printed_changes),
            build_values_table(values, printed),
            build_provenance_table(case),
        ),
    )


def _compare_runs(case: Case, before: Delivered | None, after: Delivered | None) -> Delivered | None:
    """Run after the change with the changes of the force; None if one of the runs is missing."""
    return None if before is None or after is None else _add_changes(case, before, after)


def _add_changes(case: Case, before: Delivered, after: Delivered) -> Delivered:
    """Run after the change with the changes of the force."""
    if before.record is None or after.record is None:
        return after
    changes = compare_damping_runs(_build_signals(case, before.record), _build_signals(case, after.record))
    return replace(after, study=StudyResult(changes.values))


def _build_signals(case: Case, record: Record) -> RecordSignals:
    return RecordSignals(record, case.file.filter.low_pass, case.line.geometry.supports)


def _draw_rear_force(case: Case, span: int, signals: Mapping[str, RecordSignals]) -> list[Chart]:
    """Contact force of the last pantograph over one span, low-passed at 20 Hz and at 50 Hz (Figure 11 of the paper).

    The two charts stand side by side.
    """
    start, end = case.line.geometry.span(span)
    charts = []
    for cutoff in (case.file.filter.cutoff_Hz, EXTENDED_CUTOFF_HZ):
        low_pass = replace(case.file.filter.low_pass, cutoff_Hz=cutoff)
        series = []
        for model, run in signals.items():
            record = run.record
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
                    wide=False,
                )
            )
    return charts
