"""Changes of the contact force by another damping model, and their range over shifted analysis sections."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.core.figure_data import Chart, TextTable
from pantocheck.conformance.grading.record_uncertainty import MIN_SECTIONS, largest_changes
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.quantities.pantograph_signals import EXTENDED_CUTOFF_HZ, ForceChannel
from pantocheck.conformance.quantities.registry import QUANTITIES
from pantocheck.conformance.quantities.unavailable import QuantityUnavailable
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.system import (
    Delivered,
    Errored,
    Outcome,
    Skipped,
    StudyResult,
    System,
    missing_record_reason,
)
from pantocheck.conformance.studies.damping_sensitivity import PrintedValues, draw_band_bars, list_pantographs
from pantocheck.conformance.studies.vovan2015.study_report import (
    build_findings_table,
    build_provenance_table,
    draw_curve,
)

COMPARED_QUANTITIES = ("cov_20", "cov_50", *BAND_QUANTITIES)
"""Quantities of Table 1 of Vo Van, Balmes and Lorang (2015)."""

CHANGES = {quantity: f"change_{quantity.removesuffix('_N')}_pct" for quantity in COMPARED_QUANTITIES}
"""Name of the change of each quantity."""

EARLIER_LEVEL = "earlier_rms_20_50_N"
"""Name of the RMS in 20-50 Hz of the run before the change."""


@dataclass(frozen=True)
class ForceChanges:
    """Changes between two runs, over the analysis section and over shifted sections."""

    values: dict[int, dict[str, Value]]
    """Changes by pantograph (0: the line) and name."""
    shifted: tuple[dict[int, dict[str, Value]], ...] = field(default_factory=tuple)
    """Changes over each of the shifted sections, as `values`."""

    @property
    def spread(self) -> dict[int, dict[str, float]]:
        """Largest difference of each change from its value when the analysis section is shifted, in its unit."""
        return largest_changes(self.values, self.shifted, MIN_SECTIONS)

    def list_shifted(self, owner: int, name: str) -> list[float]:
        """Values of a change over the shifted sections, as far as they are known."""
        found = (part.get(owner, {}).get(name) for part in self.shifted)
        return [value for value in found if isinstance(value, float)]


def compare_damping_runs(
    before: RecordSignals, after: RecordSignals, sections: Sequence[tuple[float, float]] = ()
) -> ForceChanges:
    """Changes from a run with the earlier damping to one with that of the case, also over shifted sections [m, m]."""
    shifted = (
        compare_force(before.evaluate_section(section).values, after.evaluate_section(section).values)
        for section in sections
    )
    return ForceChanges(compare_force(before.evaluation.values, after.evaluation.values), tuple(shifted))


def compare_force(before: ValuesByOwner, after: ValuesByOwner) -> dict[int, dict[str, Value]]:
    """Changes of the statistics of the contact force [%].

    Returns:
        Changes by pantograph and name, without those that one side lacks. The line holds the comparison of the first
        with the last pantograph.
    """
    findings: dict[int, dict[str, Value]] = {}
    for pantograph in before.keys() & after.keys() - {LINE}:
        findings[pantograph] = {}
        for quantity, name in CHANGES.items():
            old, new = before[pantograph].get(quantity), after[pantograph].get(quantity)
            if isinstance(old, float) and isinstance(new, float) and old > 0:
                findings[pantograph][name] = 100 * (new / old - 1)
                if quantity == "rms_20_50_N":
                    findings[pantograph][EARLIER_LEVEL] = old
    line = _compare_pantographs(findings, (before, after), last=max(findings, default=1))
    return {**findings, LINE: line} if line else findings


def _compare_pantographs(
    changes: Mapping[int, Mapping[str, Value]], runs: Sequence[ValuesByOwner], last: int
) -> dict[str, Value]:
    """First and last pantograph: difference of the changes in 20-50 Hz, and order of the levels in each band."""
    if last == 1:
        return {}
    line: dict[str, Value] = {}
    rear, front = (changes.get(pantograph, {}).get(CHANGES["rms_20_50_N"]) for pantograph in (last, 1))
    if isinstance(rear, float) and isinstance(front, float):
        line["rear_over_front_change_20_50_pct"] = rear - front
    for band in BAND_QUANTITIES:
        levels = [(run.get(last, {}).get(band), run.get(1, {}).get(band)) for run in runs]
        ratios = [
            float(other / first)
            for other, first in levels
            if isinstance(other, float) and isinstance(first, float) and first > 0
        ]
        if len(ratios) == len(runs):
            line[f"largest_rear_over_front_{band.removesuffix('_N')}"] = max(ratios)
            line[f"smallest_rear_over_front_{band.removesuffix('_N')}"] = min(ratios)
    return line


# Tables of a changed damping: computed and printed values, and the changes with their range.
def build_values_table(values: Mapping[str, ValuesByOwner], printed: PrintedValues) -> TextTable:
    """Build a table of the computed and printed values; printed ones are by damping model and pantograph."""
    pantographs = list_pantographs(values)
    rows = []
    for quantity in ("mean_force_N", *COMPARED_QUANTITIES, "contact_loss_pct"):
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


def build_changes_table(changes: ForceChanges, printed: ValuesByOwner) -> TextTable:
    """Build a table of the changes: printed, computed, and smallest and largest value over shifted sections."""
    rows = []
    for owner, values in sorted(changes.values.items(), key=lambda item: (item[0] == LINE, item[0])):
        for name, value in values.items():
            shifted = changes.list_shifted(owner, name)
            numbers = [printed.get(owner, {}).get(name), value, min(shifted, default=None), max(shifted, default=None)]
            cells = [f"{number:.3g}" if isinstance(number, float) else "-" for number in numbers]
            rows.append([QUANTITIES[name].label, "both" if owner == LINE else str(owner), *cells])
    sections = len(changes.shifted)
    return TextTable(
        caption="Changes by the damping [%], level before it [N], comparison of the two pantographs, and their range "
        f"over {sections} positions of the analysis section.",
        columns=["Quantity", "Pantograph", "Printed", "Computed", "Smallest", "Largest"],
        rows=rows,
    )


# Change of the contact force by another damping model, band by band (Vo Van, Balmes and Lorang 2015, Table 1).
def run_damping_change(case: Case, study: DampingChange, system: System) -> Outcome:
    """Run a passage with the damping before the change and with that of the case, and compare the bands.

    Without a record of both runs, the outcome is the reason.
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
    printed_changes = compare_force(
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
    return RecordSignals(record, case.file.filter, case.line.geometry.supports)


def _draw_rear_force(case: Case, span: int, signals: Mapping[str, RecordSignals]) -> list[Chart]:
    """Contact force of the last pantograph over one span, low-passed at 20 Hz and at 50 Hz (Figure 11 of the paper).

    The two charts stand side by side.
    """
    start, end = case.line.geometry.span(span)
    charts = []
    for cutoff in (case.file.filter.cutoff_Hz, EXTENDED_CUTOFF_HZ):
        low_pass = case.file.filter.change_cutoff(cutoff)
        series = []
        for model, run in signals.items():
            record = run.record
            try:
                force = ForceChannel(record.force[-1], record.rate, low_pass, record.filter_applied_Hz).graded
            except QuantityUnavailable:
                continue
            position = record.position[-1]
            inside = (position >= start) & (position <= end)
            series.append(draw_curve(model, position[inside], force[inside]))
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
