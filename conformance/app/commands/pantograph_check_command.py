"""`pantocheck pantograph check`: an FMU as a pantograph."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text
from pantocheck.conformance.app.self_test.fmu_check import check_fmu
from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pantograph.response_record import read_response


def pantograph_check_command(
    model: Annotated[Path, typer.Argument(help="FMU, or pantograph file with a table [fmu]. Its code is run.")],
    uplift_force: Annotated[float, typer.Option("--uplift-force-N", help="Uplift force.", min=1.0, max=1000.0)] = 120.0,
    step: Annotated[float, typer.Option(help="Time step of the coupling [s].", min=1e-5, max=0.01)] = 0.001,
    response: Annotated[
        list[Path] | None,
        typer.Option(help="Sidecar of a response measured at the head; repeat it for several."),
    ] = None,
) -> CommandOutput:
    """Check an FMU as a pantograph: interface, response, energy.

    The FMU runs in a process of its own. The output names its model and units, and whether a step can be repeated. The
    static force and the response of the head are compared with the linear model of the pantograph file, the response
    also with measured ones if they are given. Energy that the head delivers, determinism, the effect of half of the
    step, and the time of a step are measured. Exit code 0: nothing is wrong. Exit code 1: something is wrong. Exit code
    2: a file cannot be used.

    Example: pantocheck pantograph check model.fmu
    """
    measured = [read_response(path) for path in response or ()]
    check = check_fmu(read_named_pantograph(model), uplift_force, step, measured)
    wrong = sum(finding.state == "wrong" for finding in check.findings)
    text = "Nothing is wrong." if check.passed else f"{wrong} of {count_noun(len(check.findings), 'finding')} wrong."
    rows = ((finding.state, finding.subject, escape_text(finding.text)) for finding in check.findings)
    return CommandOutput(
        Text(text),
        asdict(check),
        [build_table("state", "subject", "finding", unbroken=("state", "subject"), rows=rows)],
        exit_code=0 if check.passed else 1,
    )
