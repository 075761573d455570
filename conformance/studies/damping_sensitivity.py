"""One passage under several damping models, side by side: how much a line's contact force owes to its damping."""

from collections.abc import Mapping
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.damping_file import DampingFile
from pantocheck.conformance.cases.library import library_folder
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, ValuesByOwner
from pantocheck.conformance.quantities.registry import table_quantities
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.results.outcome import Delivered, Outcome, StudyResult, missing_record_reason
from pantocheck.conformance.results.results_format import TextTable
from pantocheck.conformance.studies.force_charts import draw_band_bars
from pantocheck.conformance.systems.system import System

MODELS = {name: f"vovan2015/damping/{name}.toml" for name in ("benchmark", "initial", "updated")}
"""Damping files of the library that a study of any line uses."""
SENSITIVITY_QUANTITIES = table_quantities("damping models")
OWN = "of the case"


def add_damping_study(case: Case) -> Case:
    """A case that is also run with the library's damping models; what has no train, or is a study, stays as it is.

    Raises
    ------
    InputError
        a damping file of the library is damaged.
    """
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
    """Run a case as it is, and once more with each of its other damping models.

    Parameters
    ----------
    case : Case
        a passage.
    system : System
        Under test.
    """
    outcome = system.run(case.without_study())
    if not isinstance(outcome, Delivered) or outcome.record is None:
        return outcome
    values, missing = {OWN: evaluate_record(outcome.record, case.file.filter.low_pass).values}, []
    for name, damping in case.dampings.items():
        run = _once(system, case.with_damping(name, damping))
        if isinstance(run, Delivered) and run.record is not None:
            values[name] = evaluate_record(run.record, case.file.filter.low_pass).values
        else:
            missing.append(f"damping '{name}': {missing_record_reason(run)}")
    return replace(
        outcome,
        warnings=(*outcome.warnings, *missing),
        study=StudyResult(charts=draw_band_bars(values, {}, BAND_QUANTITIES), tables=(_table(values),)),
    )


def _once(system: System, case: Case) -> Outcome:
    """A run without its refinement pair, where the system can be asked for one."""
    from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator

    return system.run_unrefined(case) if isinstance(system, ReferenceSimulator) else system.run(case)


def _table(values: Mapping[str, ValuesByOwner]) -> TextTable:
    owners = sorted({of for found in values.values() for of in found}, key=lambda of: (of == LINE, of))
    rows = []
    for of in owners:
        for quantity in SENSITIVITY_QUANTITIES:
            cells = [found.get(of, {}).get(quantity) for found in values.values()]
            if any(isinstance(cell, float) for cell in cells):
                who = "line" if of == LINE else f"pantograph {of}"
                texts = [f"{cell:.4g}" if isinstance(cell, float) else "-" for cell in cells]
                rows.append([quantity, who, *texts])
    return TextTable(
        caption="Damping sensitivity: the same run under several damping models",
        columns=["Quantity", "Of", *values],
        rows=rows,
    )
