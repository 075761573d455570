"""`pantocheck simulate`: record of one case."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.case_line import draw_forces
from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import escape_text
from pantocheck.conformance.app.commands.kernel_option import KernelOption, demand_kernel
from pantocheck.conformance.app.commands.options import PantographOption, SetOption, choose_train_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.commands.quantities_table import build_quantities_table, list_names, select_main
from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes, replace_pantographs
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.grading.case_evaluation import CaseEvaluation
from pantocheck.conformance.records.record_writing import check_record_path, write_record
from pantocheck.conformance.records.traces import build_pantograph_traces
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Delivered, missing_record_reason
from pantocheck.conformance.runs.system_choice import choose_system


def simulate_command(
    case: Annotated[
        str, typer.Argument(help="Id or path of one case, e.g. en50318-2002/250.", autocompletion=complete_case)
    ],
    out: Annotated[Path, typer.Option(help="Record to write: NAME.csv or NAME.h5; NAME.toml is written beside it.")],
    system: Annotated[
        str, typer.Option(help="System that simulates: builtin (reference simulator) or command:PROGRAM ARGUMENTS.")
    ] = "builtin",
    changed: SetOption = None,
    pantograph: PantographOption = None,
    folders: CasesOption = None,
    kernel: KernelOption = None,
) -> CommandOutput:
    """Simulate a case and write its record.

    Examples:

    pantocheck simulate en50318-2002/250 --out 250.csv

    pantocheck simulate my-case.toml --set speed_km_h=300 --out 300.csv

    pantocheck simulate en50318-2002/250 --kernel reference --out reference.csv
    """
    demand_kernel(kernel)
    check_record_path(out)
    catalogue, changes = open_catalogue(folders or ()), parse_changes(changed or ())
    chosen = choose_train_case(case, (*replace_pantographs(pantograph or ()), *changes), catalogue)
    simulator = choose_system(system)
    check_writable(out.parent)
    # A record holds one run, so the refined run of the reference simulator is not needed.
    run = simulator.run_unrefined if isinstance(simulator, ReferenceSimulator) else simulator.run
    with follow_steps("simulation"):
        outcome = run(chosen)
    if not isinstance(outcome, Delivered) or outcome.record is None:
        reason = missing_record_reason(outcome)
        raise InputError(f"case '{chosen.id}'", f"gives no record: {reason}", "Choose another case or system.")
    sidecar = write_record(
        out,
        outcome.record,
        case=chosen.id,
        system={"name": simulator.name, "version": simulator.version},
        run=outcome.run.model_dump(),
        further={
            "case_digest": outcome.case_digest if simulator.kind == "record" else chosen.digest,
            "changes": list(chosen.changes) or None,
            "start": None if outcome.start is None else outcome.start.model_dump(),
            "line": {"span_m": chosen.line.geometry.longest_span},
        },
        outputs=outcome.fmu_outputs,
    )
    evaluation = CaseEvaluation(chosen, outcome)
    values = {str(owner): quantities for owner, quantities in evaluation.evaluation.values.items()}
    pantographs = {} if evaluation.signals is None else evaluation.signals.pantographs
    forces = draw_forces(build_pantograph_traces(pantographs, ()))
    return CommandOutput(
        escape_text(f"{chosen.id}: simulated by {simulator.name} {simulator.version}"),
        {"case": chosen.id, "run": outcome.run, "quantities": values},
        [build_quantities_table(values, {}, select_main(values)), *forces],
        [build_quantities_table(values, {}, list_names(values))],
        files=(out, out.with_name(sidecar.name)),
    )
