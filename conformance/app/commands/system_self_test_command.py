"""`pantocheck system self-test`, `check` and `rig`: systems with known faults, gaps of an adapter, a rig."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import FittedTable, build_table, escape_text, style_verdict
from pantocheck.conformance.app.commands.options import choose_train_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.self_test.adapter_check import AdapterCheck, check_adapter
from pantocheck.conformance.app.self_test.mutants import MILD, MUTANTS, MutantResult, SelfTest, run_self_test
from pantocheck.conformance.app.self_test.numerical_faults import FAULTS, NumericalResult, run_numerical_faults
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.texts import DocumentationPage, count_noun
from pantocheck.conformance.runs.command_system import parse_command
from pantocheck.conformance.runs.rig_control import RigControl, RigLimits
from pantocheck.conformance.runs.rig_link import UdpLink
from pantocheck.conformance.runs.rig_run import build_stepped_passage, check_limits, run_rig

DEFAULT_CASES = ("en50318-2002/250", "en50318-2002/300")
NUMERICAL_CASES = ("en50318-2018/ac-simple/320-twin",)
"""Further cases of the numerical faults, without published limits."""


def system_self_test_command(
    case: Annotated[
        list[str] | None,
        typer.Argument(
            help=f"Ids of cases that the reference simulator passes.  [default: {' '.join(DEFAULT_CASES)}]",
            autocompletion=complete_case,
        ),
    ] = None,
) -> CommandOutput:
    """Test the suite with faulty systems.

    The reference simulator itself must pass. A fault (mutant) is detected if the check that it should violate fails.

    Example: pantocheck system self-test en50318-2002/250
    """
    cases = [selected for selected in select_cases(case or DEFAULT_CASES) if not selected.is_static]
    if not cases:
        raise InputError("case", "no case with a train is selected", "Select cases such as en50318-2002/250.")
    further = () if case else select_cases(NUMERICAL_CASES)
    with follow_steps("self-test", len((*FAULTS, *MUTANTS, *MILD, *cases))) as progress:
        numerical = run_numerical_faults(
            [*cases, *(extra for extra in further if not extra.is_static)], progress.begin_task
        )
        self_test = replace(run_self_test(cases, progress.begin_task), numerical=numerical)
    detected = sum(result.detected for result in self_test.severe)
    text = f" {detected} of {len(self_test.severe)} mutants detected by the expected check"
    return CommandOutput(
        style_verdict("pass" if self_test.passed else "fail") + Text(text),
        _list_detections(self_test),
        [*_describe(self_test)],
        exit_code=0 if self_test.passed else 1,
    )


def _list_detections(self_test: SelfTest) -> dict[str, object]:
    """Verdicts of all mutants and numerical faults for a program."""
    mutants = [
        {"mutant": row.mutant.name, "case": row.case, "verdict": row.verdict, "detected": row.detected}
        for row in (*self_test.severe, *self_test.mild)
    ]
    faults = [
        {"fault": row.fault.name, "case": row.case, "verdict": row.verification, "detected": row.detected}
        for row in self_test.numerical
    ]
    return {"mutants": mutants, "numerical_faults": faults}


def _describe(self_test: SelfTest) -> Iterator[RenderableType]:
    """Faults that were not detected, verdicts of the reference simulator, and tables."""
    for result in (row for row in self_test.severe if not row.detected):
        yield escape_text(
            f"NOT DETECTED: {result.mutant.name} on {result.case}, expected check: {result.mutant.expected_check}"
        )
    for name, (verdict, reason) in self_test.reference.items():
        yield escape_text(f"reference simulator on {name}: ") + style_verdict(verdict) + escape_text(f" {reason}")
    for fault in (row for row in self_test.numerical if not row.detected):
        yield escape_text(f"NOT DETECTED: {fault.fault.name} on {fault.case}, by verification")
    for title, results in (("must be detected", self_test.severe), ("may remain undetected", self_test.mild)):
        yield Padding(_build_mutant_table(title, results), (1, 0, 0, 0))
    if self_test.numerical:
        yield Padding(_build_fault_table(self_test.numerical), (1, 0, 0, 0))


def _build_mutant_table(title: str, results: Sequence[MutantResult]) -> FittedTable:
    table = build_table("mutant", "case", "verdict", "limits alone", "detected by", "reason in the report", title=title)
    for result in results:
        check = result.mutant.expected_check or ", ".join(result.checks)
        table.add_row(
            escape_text(result.mutant.name),
            escape_text(result.case),
            style_verdict(result.verdict),
            style_verdict(result.by_limits),
            escape_text(check if result.detected else f"not by {check}"),
            escape_text(result.reason[:160]),
        )
    return table


def _build_fault_table(results: Sequence[NumericalResult]) -> FittedTable:
    columns = ("numerical fault", "case", "EN 50318 criteria", "verification", "quantities outside")
    table = build_table(*columns, title="numerical faults")
    for result in results:
        fault = result.fault.name if result.fault.must_be_detected else f"{result.fault.name} (optional)"
        table.add_row(
            escape_text(fault),
            escape_text(result.case),
            style_verdict(result.criteria),
            style_verdict(result.verification),
            escape_text(", ".join(result.outside) or "none"),
        )
    return table


# `pantocheck system check`: the adapter of a simulator, with short cases.
ADAPTER_TIMEOUT_S = 600.0
"""Default time limit of the short case [s], that of a case of `run`."""


def system_check_command(
    command: Annotated[str, typer.Argument(help="Program and arguments in quotes, as after `command:` of `run`.")],
    timeout: Annotated[float, typer.Option(help="Time limit of each short case [s].")] = ADAPTER_TIMEOUT_S,
) -> CommandOutput:
    """Check the adapter of a simulator with short cases.

    The program is started, receives a case of a few seconds, and its record is checked. The output names all that is
    missing or wrong, and lays the values beside those of the reference simulator. Two further messages are the line at
    rest and the case with two pantographs; the program may refuse them. Exit code 0: nothing is missing or
    wrong. Exit code 1: something is missing or wrong. Exit code 2: the program does not exist.

    Example: pantocheck system check 'python3 adapter.py'
    """
    system = parse_command(command.removeprefix("command:"), Path.cwd(), timeout)
    check = check_adapter(system)
    gaps = sum(finding.state in ("missing", "wrong") for finding in check.findings)
    share = f"{gaps} of {count_noun(len(check.findings), 'finding')}"
    text = "Nothing is missing." if check.passed else f"{share} {'needs' if gaps == 1 else 'need'} a correction."
    started = f"{system.name} {system.version} started and answered."
    return CommandOutput(
        Text(text),
        asdict(check),
        [*([escape_text(started)] if system.start_failure is None else []), *_build_check_tables(check)],
        exit_code=0 if check.passed else 1,
    )


def _build_check_tables(check: AdapterCheck) -> Iterator[RenderableType]:
    findings = ((finding.state, finding.subject, escape_text(finding.text)) for finding in check.findings)
    yield build_table("state", "subject", "finding", unbroken=("state", "subject"), rows=findings)
    if check.values:
        numbers = ("adapter", "reference", "difference")
        values = (
            (value.name, f"{value.value:.4g}", f"{value.reference:.4g}", f"{value.difference:+.1%}")
            for value in check.values
        )
        yield build_table("quantity", *numbers, right=numbers, rows=values)


# `pantocheck system rig`: a line against an actuator and a force sensor, in real time.
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
