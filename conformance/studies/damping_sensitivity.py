"""Damping sensitivity: the passage of any case under several damping models."""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.damping_file import DampingFile
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.quantities.registry import table_quantities
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.figure_data import TextTable
from pantocheck.conformance.results.outcome import Delivered, Outcome, StudyResult, missing_record_reason
from pantocheck.conformance.step_log import use_part
from pantocheck.conformance.studies.band_charts import draw_band_bars
from pantocheck.conformance.systems.system import System

MODELS = {name: f"vovan2015/damping/{name}.toml" for name in ("benchmark", "initial", "updated")}
"""Damping files of the library by name of the model, for the damping study of any line."""
TABLE_ROWS = table_quantities("damping models")
REFINED_RUN = 5.0
"""Estimated duration of the first run, with its refined runs and other starts, in runs with one mesh."""
CASE_DAMPING = "of the case"
"""Name of the model for the damping of the case."""


def add_damping_study(case: Case) -> Case:
    """Add runs with the damping models of the library to a case; a static case or a study stays unchanged."""
    if case.is_static or case.file.study is not None:
        return case
    dampings = {
        name: read_model(library_folder() / path, DampingFile, "damping").damping for name, path in MODELS.items()
    }
    study = DampingSensitivity(
        kind="damping-sensitivity", models=MODELS, trust="provisional", source="damping models of vovan2015"
    )
    return replace(case, file=case.file.model_copy(update={"study": study}), dampings=dampings)


def run_damping_sensitivity(case: Case, system: System) -> Outcome:
    """Run a passage with the damping of the case and with each damping model of its study."""
    whole = REFINED_RUN + len(case.dampings)
    with use_part(0.0, REFINED_RUN / whole):
        outcome = system.run(case.without_study())
    if not isinstance(outcome, Delivered) or outcome.record is None:
        return outcome
    low_pass, supports = case.file.filter.low_pass, case.line.geometry.supports
    values, missing = {CASE_DAMPING: evaluate_record(outcome.record, low_pass, supports).values}, []
    for number, (name, damping) in enumerate(case.dampings.items()):
        with use_part((REFINED_RUN + number) / whole, (REFINED_RUN + number + 1) / whole):
            run = _run_unrefined(system, case.with_damping(name, damping))
        if isinstance(run, Delivered) and run.record is not None:
            values[name] = evaluate_record(run.record, low_pass, supports).values
        else:
            missing.append(f"damping '{name}': {missing_record_reason(run)}")
    return replace(
        outcome,
        warnings=(*outcome.warnings, *missing),
        study=StudyResult(charts=draw_band_bars(values, {}, BAND_QUANTITIES), tables=(_comparison_table(values),)),
    )


def _run_unrefined(system: System, case: Case) -> Outcome:
    """Run a case; the reference simulator leaves out its refined run."""
    from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator

    return system.run_unrefined(case) if isinstance(system, ReferenceSimulator) else system.run(case)


def _comparison_table(values: Mapping[str, ValuesByOwner]) -> TextTable:
    owners = sorted({owner for model in values.values() for owner in model}, key=lambda owner: (owner == LINE, owner))
    rows = []
    for owner in owners:
        name = "line" if owner == LINE else f"pantograph {owner}"
        for quantity in TABLE_ROWS:
            numbers = [model.get(owner, {}).get(quantity) for model in values.values()]
            cells = [f"{number:.4g}" if isinstance(number, float) else "-" for number in numbers]
            if set(cells) != {"-"}:
                rows.append([quantity, name, *cells])
    return TextTable(
        caption="Damping sensitivity: the same run under several damping models",
        columns=["Quantity", "Pantograph or line", *values],
        rows=rows,
    )
