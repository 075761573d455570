"""Change of the contact force by another damping model, band by band (Vo Van, Balmes and Lorang 2015, Table 1)."""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingChange
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.outcome import (
    Delivered,
    Errored,
    Outcome,
    Skipped,
    StudyResult,
    missing_record_reason,
)
from pantocheck.conformance.results.results_format import TextTable
from pantocheck.conformance.studies.force_charts import PrintedValues, draw_band_bars, draw_trailing_force
from pantocheck.conformance.studies.vovan2015.findings_table import build_findings_table
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table
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
    """
    ((name, damping),) = case.dampings.items()
    runs: dict[str, Delivered] = {}
    for model, variant in ((name, case.with_damping(name, damping)), (study.after, case.without_study())):
        outcome = system.run(variant)
        if not isinstance(outcome, Delivered) or outcome.record is None:
            failure = Skipped if isinstance(outcome, Skipped) else Errored
            return failure(f"{model}: {missing_record_reason(outcome)}")
        runs[model] = outcome
    before, after = runs[name], runs[study.after]
    values = {model: _evaluate(case, run) for model, run in runs.items()}
    findings = band_changes(values[name], values[study.after])
    refined = after.refined
    if refined is not None and before.refined is not None:
        refined_findings = band_changes(_evaluate(case, before.refined), _evaluate(case, refined))
        refined = replace(refined, study=StudyResult(refined_findings))
    printed = {(table.model, table.pantograph): table.values for table in study.printed}
    return replace(
        after,
        refined=refined,
        study=StudyResult(
            findings=findings,
            charts=(*draw_band_bars(values, printed, BAND_QUANTITIES), *draw_trailing_force(case, study, runs)),
            tables=(
                build_findings_table(case.limits, findings, _printed_changes(printed, name, study.after)),
                _comparison_table(values, printed),
                build_provenance_table(case),
            ),
        ),
    )


def band_changes(before: ValuesByOwner, after: ValuesByOwner) -> dict[int, dict[str, Value]]:
    """Changes of the RMS of the bands, by pantograph (0: difference of the last and the first) and name.

    Parameters
    ----------
    before, after : ValuesByOwner
        Quantities by pantograph and name; a band that one of them lacks is left out.
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


def _evaluate(case: Case, run: Delivered) -> ValuesByOwner:
    return {} if run.record is None else evaluate_record(run.record, case.file.filter.low_pass).values


def _printed_changes(printed: PrintedValues, before: str, after: str) -> dict[int, dict[str, Value]]:
    return band_changes(
        *(
            {pantograph: dict(values) for (model, pantograph), values in printed.items() if model == name}
            for name in (before, after)
        )
    )


def _comparison_table(values: Mapping[str, ValuesByOwner], printed: PrintedValues) -> TextTable:
    """Computed and printed values side by side."""
    pantographs = sorted({number for model_values in values.values() for number in model_values if number != LINE})
    rows = []
    for quantity in PRINTED_QUANTITIES:
        for model, computed in values.items():
            row = [quantity, model]
            for number in pantographs:
                for cells in (computed.get(number, {}), printed.get((model, number), {})):
                    row.append(_format_number(cells.get(quantity)))
            rows.append(row)
    heads = [f"{origin}, pantograph {number}" for number in pantographs for origin in ("computed", "printed")]
    return TextTable(
        caption="Computed beside printed. Line and pantograph are assumed: absolute values are informative.",
        columns=["Quantity", "Damping", *heads],
        rows=rows,
    )


def _format_number(value: Value | None) -> str:
    return f"{value:.3g}" if isinstance(value, int | float) else "-"
