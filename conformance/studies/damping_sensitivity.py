"""Damping sensitivity: a passage under several damping models, with bar charts of the contact force by band."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.core.figure_data import Chart, Series, TextTable
from pantocheck.conformance.core.step_log import use_part
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.line.elements.damping import DampingFile
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.quantities.bands import BAND_QUANTITIES
from pantocheck.conformance.quantities.evaluation import LINE, Value, ValuesByOwner
from pantocheck.conformance.quantities.registry import list_table_quantities
from pantocheck.conformance.records.record_signals import evaluate_record
from pantocheck.conformance.runs.system import Delivered, Outcome, StudyResult, System, missing_record_reason

PrintedValues = Mapping[tuple[str, int], Mapping[str, float]]
"""Printed values of a publication by damping model and pantograph, then by name of quantity."""


def list_pantographs(values: Mapping[str, ValuesByOwner]) -> list[int]:
    """Numbers of all pantographs with values, in running order."""
    return sorted({number for model_values in values.values() for number in model_values if number != LINE})


def draw_band_bars(
    values: Mapping[str, ValuesByOwner], printed: PrintedValues, bands: Sequence[str]
) -> tuple[Chart, ...]:
    """Draw one bar chart per pantograph: computed and printed RMS of the contact force in each band.

    Bands are names of quantities; values are by damping model, and printed ones may be missing.
    """
    origin = "computed on the assumed line and printed" if printed else "computed under each damping model"
    table = "computed and printed values" if printed else "the same run under several damping models"
    charts = []
    for p in list_pantographs(values):
        series = [_draw_bars(f"computed, {model}", computed.get(p, {}), bands) for model, computed in values.items()]
        series += [
            _draw_bars(f"printed, {model}", printed[model, p], bands) for model in values if (model, p) in printed
        ]
        charts.append(
            Chart(
                caption=f"Pantograph {p}: RMS of the contact force by band, {origin}.",
                alternative=f"The bars show the numbers in the table of {table}.",
                x_label="band [Hz]",
                y_label="RMS [N]",
                ticks=[band.removeprefix("rms_").removesuffix("_N").replace("_", "–") for band in bands],
                series=[bars for bars in series if bars.x],
            )
        )
    return tuple(charts)


def _draw_bars(label: str, values: Mapping[str, Value], bands: Sequence[str]) -> Series:
    known = {float(i): value for i, band in enumerate(bands) if isinstance(value := values.get(band), float)}
    return Series(label=label, style="bars", x=list(known), y=list(known.values()))


# Damping sensitivity: the passage of any case under several damping models.
MODELS = {name: f"vovan2015/damping/{name}.toml" for name in ("benchmark", "initial", "updated")}
"""Damping files of the library by name of the model, for the damping study of any line."""
TABLE_ROWS = list_table_quantities("damping models")
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
    settings = case.file.filter, case.line.geometry.supports, (case.start_positions[0], case.end)
    values, missing = {CASE_DAMPING: evaluate_record(outcome.record, *settings).values}, []
    for number, (name, damping) in enumerate(case.dampings.items()):
        with use_part((REFINED_RUN + number) / whole, (REFINED_RUN + number + 1) / whole):
            run = _run_unrefined(system, case.with_damping(name, damping))
        if isinstance(run, Delivered) and run.record is not None:
            values[name] = evaluate_record(run.record, *settings).values
        else:
            missing.append(f"damping '{name}': {missing_record_reason(run)}")
    return replace(
        outcome,
        warnings=(*outcome.warnings, *missing),
        study=StudyResult(charts=draw_band_bars(values, {}, BAND_QUANTITIES), tables=(_comparison_table(values),)),
    )


def _run_unrefined(system: System, case: Case) -> Outcome:
    """Run a case; the reference simulator leaves out its refined run."""
    from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator

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
