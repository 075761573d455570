"""The same passage under two damping models: what the change does to the contact force, band by band."""

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
from pantocheck.conformance.studies.force_charts import draw_band_bars, trailing_force
from pantocheck.conformance.studies.vovan2015.findings_table import build_findings_table
from pantocheck.conformance.studies.vovan2015.provenance_table import build_provenance_table
from pantocheck.conformance.systems.system import System

CHANGE_QUANTITIES = ("cov_20", "cov_50", *BAND_QUANTITIES)


def run_damping_change(case: Case, study: DampingChange, system: System) -> Outcome:
    """Run a passage with the damping before and with that of the case, and compare.

    Parameters
    ----------
    case : Case
        The passage.
    study : DampingChange
        The damping before, and printed values.
    system : System
        Under test; it is asked for both passages.
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
    values = {name: _values(case, before), study.after: _values(case, after)}
    found = band_changes(values[name], values[study.after])
    refined = after.refined
    if refined is not None and before.refined is not None:
        fine = band_changes(_values(case, before.refined), _values(case, refined))
        refined = replace(refined, study=StudyResult(fine))
    printed = {(one.model, one.pantograph): one.values for one in study.printed}
    paper = _printed_changes(printed, name, study.after)
    return replace(
        after,
        refined=refined,
        study=StudyResult(
            findings=found,
            charts=(
                *draw_band_bars(values, printed, BAND_QUANTITIES),
                *trailing_force(case, study, runs),
            ),
            tables=(
                build_findings_table(case.limits, found, paper),
                _beside(values, printed),
                build_provenance_table(case),
            ),
        ),
    )


def band_changes(before: ValuesByOwner, after: ValuesByOwner) -> dict[int, dict[str, Value]]:
    """Changes of the bands' RMS, by pantograph (0: between the first and the last) and name.

    Parameters
    ----------
    before, after : ValuesByOwner
        Quantities by pantograph and name; a band that one of them lacks is left out.
    """
    found: dict[int, dict[str, Value]] = {}
    for pantograph in before.keys() & after.keys() - {LINE}:
        found[pantograph] = {}
        for band in BAND_QUANTITIES:
            old, new = before[pantograph].get(band), after[pantograph].get(band)
            if isinstance(old, float) and isinstance(new, float) and old > 0:
                found[pantograph][f"change_{band.removesuffix('_N')}_pct"] = 100 * (new / old - 1)
    last, high = max(found, default=1), "change_rms_20_50_pct"
    front_of = found.get(1, {})
    if last > 1 and high in front_of and high in found[last]:
        rear, front = found[last][high], front_of[high]
        if isinstance(rear, float) and isinstance(front, float):
            found[LINE] = {"rear_over_front_change_20_50_pct": rear - front}
    return found


def _values(case: Case, outcome: Delivered) -> ValuesByOwner:
    if outcome.record is None:
        return {}
    return evaluate_record(outcome.record, case.file.filter.low_pass).values


def _printed_changes(
    printed: Mapping[tuple[str, int], Mapping[str, float]], before: str, after: str
) -> dict[int, dict[str, Value]]:
    return band_changes(
        *({p: dict(v) for (model, p), v in printed.items() if model == name} for name in (before, after))
    )


def _beside(values: Mapping[str, ValuesByOwner], printed: Mapping[tuple[str, int], Mapping[str, float]]) -> TextTable:
    """Computed values beside the printed ones."""
    pantographs = sorted({p for of in values.values() for p in of if p != LINE})
    rows = []
    for quantity in CHANGE_QUANTITIES:
        for model, of in values.items():
            row = [quantity, model]
            for p in pantographs:
                row += [_number(of.get(p, {}).get(quantity)), _number(printed.get((model, p), {}).get(quantity))]
            rows.append(row)
    heads = [f"{what}, pantograph {p}" for p in pantographs for what in ("computed", "printed")]
    return TextTable(
        caption="Computed beside printed. Line and pantograph are assumed: absolute values are informative.",
        columns=["Quantity", "Damping", *heads],
        rows=rows,
    )


def _number(value: Value | None) -> str:
    return f"{value:.3g}" if isinstance(value, int | float) else "-"
