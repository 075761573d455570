"""`pantocheck system rig`: a line against an actuator and a force sensor, in real time."""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text
from pantocheck.conformance.app.commands.options import choose_train_case
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage, count_noun
from pantocheck.conformance.runs.rig_control import RigControl, RigLimits
from pantocheck.conformance.runs.rig_link import UdpLink
from pantocheck.conformance.runs.rig_run import build_stepped_passage, check_limits, run_rig


def system_rig_command(
    case: Annotated[
        str, typer.Argument(help="Id or path of a case with one pantograph.", autocompletion=complete_case)
    ],
    rig: Annotated[str, typer.Option(help=f"Address of the rig, HOST:PORT; see {DocumentationPage.RIG}.")],
    out: Annotated[Path, typer.Option(help="Folder for rig.json, log.npy and the record of the last passage.")],
    passages: Annotated[int, typer.Option(help="Number of passages, one after the other.", min=1)] = 1,
    step: Annotated[float, typer.Option(help="Time step of line and messages [s].", min=1e-4, max=1e-3)] = 1e-3,
    force: Annotated[float, typer.Option("--force-limit-N", help="Limit of the measured force.", min=1.0)] = 350.0,
    travel: Annotated[
        float, typer.Option("--travel-limit-mm", help="Limit of the distance of the head from its start.", min=1.0)
    ] = 150.0,
    speed: Annotated[
        float, typer.Option("--speed-limit-m-s", help="Limit of the commanded speed of the head.", min=0.01)
    ] = 1.0,
    correction: Annotated[
        float, typer.Option("--correction-limit-N", help="Limit of the correction of the linear model.", min=1.0)
    ] = 60.0,
    watchdog: Annotated[
        float, typer.Option("--watchdog-ms", help="Longest silence of the rig, and lateness of a step.", min=2.0)
    ] = 20.0,
    connection: Annotated[float, typer.Option("--connection-s", help="Longest wait for the rig.", min=0.1)] = 10.0,
    cutoff: Annotated[float, typer.Option("--cutoff-Hz", help="Cut-off of the correction.", min=1.0, max=200.0)] = 50.0,
) -> CommandOutput:
    """Run a line against a pantograph on a rig.

    The wire of the case moves the actuator under a real pantograph, and the measured force acts on the line. A limit
    that is exceeded brakes the head and ends the run. Exit code 0: all passages are complete. Exit code 1: a limit
    stopped the run. Exit code 2: an input cannot be used, or there is no rig.

    Example: pantocheck system rig en50318-2002/250 --rig 192.168.0.20:5318 --out rig
    """
    chosen = choose_train_case(case, ())
    check_writable(out)
    limits = RigLimits(force, travel / 1000, speed, correction, watchdog / 1000, connection)
    line = build_stepped_passage(chosen, step)
    check_limits(line, limits)
    control = RigControl(line, limits, cutoff, passages)
    with closing(UdpLink(rig)) as link:
        summary = run_rig(chosen, control, link, out)
    if not control.samples:
        raise InputError(f"rig '{rig}'", control.reason, "Start the rig first, and check its address.")
    rows = (
        (name, *(f"{summary[key][column]:g}" for column in ("median_us", "99.99_pct_us", "worst_us")))
        for name, key in (("step", "work"), ("lateness", "lateness"), ("delay of the rig", "delay"))
    )
    done = count_noun(summary["passages"], "passage")
    missed = f"{summary['missed_deadlines']} of {summary['steps']} deadlines missed"
    numbers = ("median [us]", "99.99 % [us]", "worst [us]")
    files = [path for path in (out / name for name in ("rig.json", "log.npy", "record.csv")) if path.exists()]
    return CommandOutput(
        Text(f"{done}, {missed}" if not control.reason else f"stopped: {control.reason}"),
        summary,
        [build_table("time", *numbers, right=numbers, rows=rows), escape_text(f"{chosen.id}: {done}, {missed}")],
        files=files,
        exit_code=1 if control.reason else 0,
    )
