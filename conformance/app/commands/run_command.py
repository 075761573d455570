"""`pantocheck run` and `assess`: grading of cases on a system, or of a record by a profile, with a certificate."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import EXIT_CODES, CommandOutput
from pantocheck.conformance.app.commands.console import error_console, escape_text
from pantocheck.conformance.app.commands.interruption import Interruption, receive_signals
from pantocheck.conformance.app.commands.kernel_option import KernelOption, demand_kernel
from pantocheck.conformance.app.commands.options import (
    AcceptUnconfirmedOption,
    AdministrationOption,
    BaselineOption,
    DecisionOption,
    DriftOption,
    FormatsOption,
    LanguageOption,
    OutOption,
    PantographOption,
    ReportNumberOption,
    SetOption,
    TrustOption,
    VerdictsOption,
    build_options,
    read_stated_administration,
)
from pantocheck.conformance.app.commands.output_settings import current_settings
from pantocheck.conformance.app.commands.progress_display import report_cases
from pantocheck.conformance.app.commands.results_output import build_results_output
from pantocheck.conformance.cases.library import read_limits
from pantocheck.conformance.cases.limits import repeat_limits
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.decision import parse_decision
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.processes import count_processors, interruption_exit_code
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.execution.plan import Plan, PreparedPlan, locate_plan, locate_record, prepare_plan
from pantocheck.conformance.execution.runner import RunInterrupted, add_reference, run_cases
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.baseline import compare_with_baseline, read_baseline
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_all
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.report_files import FILES, check_formats
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.reference_simulator import estimate_work
from pantocheck.conformance.runs.system_choice import use_threads

CasesArgument = Annotated[
    list[str] | None,
    typer.Argument(
        help="Ids, globs or paths of cases; default: those that count for the verdicts.", autocompletion=complete_case
    ),
]
PlanOption = Annotated[
    Path | None, typer.Option(help="TOML file with the options of a run; see `pantocheck schema plan`.")
]
SystemOption = Annotated[
    str | None, typer.Option(help="System under test: builtin, record:DIR or command:PROGRAM.", show_default="builtin")
]
LimitsOption = Annotated[
    Path | None, typer.Option(help="TOML file of your own limits, which replace those of the cases.")
]
MOST_THREADS = 4
"""Largest number of threads of a case by default: the halved mesh alone takes a third of its time."""

JobsOption = Annotated[
    int | None,
    typer.Option(
        help="Number of processors, for cases and for the meshes of a case.",
        show_default="one case at a time, whose meshes use all, at most 4",
    ),
]
DampingStudyOption = Annotated[
    bool, typer.Option("--damping-study", help="Run every case also with benchmark, initial and updated damping.")
]
WithReferenceOption = Annotated[
    bool,
    typer.Option(
        "--with-reference",
        help="Show the values and forces of the reference simulator beside those of the system, for information.",
    ),
]
TimeoutOption = Annotated[
    float | None, typer.Option(help="Time limit of an external program per case [s].", show_default="600")
]


def run_command(
    case: CasesArgument = None,
    plan: PlanOption = None,
    folders: CasesOption = None,
    system: SystemOption = None,
    changed: SetOption = None,
    pantograph: PantographOption = None,
    out: OutOption = None,
    formats: FormatsOption = None,
    language: LanguageOption = None,
    trust: TrustOption = None,
    decision: DecisionOption = None,
    verdicts: VerdictsOption = None,
    limits: LimitsOption = None,
    accept_unconfirmed: AcceptUnconfirmedOption = None,
    baseline: BaselineOption = None,
    drift: DriftOption = None,
    administration: AdministrationOption = None,
    report_number: ReportNumberOption = None,
    jobs: JobsOption = None,
    damping_study: DampingStudyOption = False,
    with_reference: WithReferenceOption = False,
    timeout: TimeoutOption = None,
    kernel: KernelOption = None,
) -> CommandOutput:
    """Run and grade cases on a system; write a certificate.

    Examples:

    pantocheck run 'en50318-2002/*' --out report

    pantocheck run en50318-2002/250 --damping-study

    pantocheck run my-case.toml --system record:records --formats html,json

    pantocheck run 'en50318-2002/*' --system 'command:python3 adapter.py'

    pantocheck run my-case.toml --set speed_km_h=300 --set line.contact_wire.tension_N=22e3

    pantocheck run 'en50318-2002/*' --system record:records --with-reference

    pantocheck run my-case.toml --pantograph model.fmu

    pantocheck run 'own/*' --cases my-cases

    pantocheck run --plan conformance.toml --baseline results.json --drift 2
    """
    demand_kernel(kernel)
    settings = {"trust": trust, "decision": decision, "verdicts": verdicts, "limits": limits, "baseline": baseline}
    run = {"system": system, "jobs": jobs, "damping_study": damping_study or None, "timeout_s": timeout}
    options = build_options(
        plan,
        formats,
        cases=case,
        case_folders=folders,
        set=changed,
        pantograph=pantograph,
        out=out,
        language=language,
        accept_unconfirmed=accept_unconfirmed,
        drift_pct=drift,
        administration=read_stated_administration(administration, report_number),
        **settings,
        **run,
    )
    if with_reference and options.system == "builtin":
        found = "the system under test is the reference simulator"
        raise InputError("--with-reference", found, "Name another system by --system.")
    return _run_plan(options, plan, with_reference)


def _run_plan(options: Plan, plan: Path | None, with_reference: bool) -> CommandOutput:
    """Run the cases of the options, and write the reports; `plan` is the file of a plan."""
    prepared = prepare_plan(options)
    places = locate_plan(options, plan)
    with receive_signals(prepared.out / FILES["json"], len(prepared.cases)) as interruption:
        results, exit_code = _run_cases(prepared, with_reference, interruption)
        if exit_code:
            typer.echo("Interrupted: the results of the finished cases are written.", err=True)
        results = results.model_copy(update={"administration": options.administration})
        if prepared.baseline is not None:
            write_all(results, prepared.out, ("json",))  # kept if the comparison fails
            results = prepared.compare(results)
        files = write_all(results, prepared.out, prepared.formats, places, options.language)
        remarks = remark_missing_formats(options.formats)
        exit_code = exit_code or interruption.exit_code or EXIT_CODES[results.verdict]
        return build_results_output(results, files, exit_code, remarks)


def _run_cases(prepared: PreparedPlan, with_reference: bool, interruption: Interruption) -> tuple[Results, int]:
    """Results of the finished cases, and the exit code of an interruption or 0."""
    system, cases, plan = prepared.start_system(), prepared.cases, prepared.plan
    if prepared.added and current_settings().detail != "quiet":
        parts = (f"{name} (required by {', '.join(others)})" for name, others in prepared.added.items())
        error_console().print(escape_text(f"cases added: {'; '.join(parts)}"), soft_wrap=True)
    jobs = min(plan.jobs or 1, len(cases))
    system = use_threads(system, min(count_processors(), MOST_THREADS) if plan.jobs is None else plan.jobs // jobs)
    work = {case.id: estimate_work(case) for case in cases}
    try:
        with report_cases(len(cases), work=work) as progress:
            follow = interruption.follow(progress, len(cases))
            results = run_cases(cases, system, plan.trust, jobs, follow, prepared.participation)
    except RunInterrupted as interrupted:
        return interrupted.results, interrupted.exit_code
    if not with_reference or interruption.exit_code:
        return results, 0
    try:
        with report_cases(len(cases), "reference simulator", work) as progress:
            return add_reference(results, cases, jobs, interruption.follow(progress, len(cases))), 0
    except RunInterrupted as interrupted:
        return interrupted.results, interrupted.exit_code
    except KeyboardInterrupt as interrupted:  # before the first case of the reference simulator
        return results, interruption_exit_code(interrupted)


def assess_command(
    record: Annotated[Path, typer.Argument(help="Record: its sidecar, its table, or a summary record.")],
    profile: Annotated[
        str,
        typer.Option(
            help="acceptance-ac, acceptance-dc-3kv, acceptance-dc-1500v, line-test, or the path of your own .toml file."
        ),
    ],
    measured: Annotated[
        Path | None, typer.Option(help="Measured record to compare with, for a profile such as line-test.")
    ] = None,
    out: OutOption = None,
    formats: FormatsOption = None,
    language: LanguageOption = None,
    trust: TrustOption = None,
    decision: DecisionOption = None,
    limits: Annotated[
        Path | None, typer.Option(help="TOML file of your own limits, which replace the rules of the profile.")
    ] = None,
    wave_speed_m_s: Annotated[
        float | None, typer.Option(help="Wave propagation speed of the contact wire, if the record does not state it.")
    ] = None,
    uplift_space_mm: Annotated[
        float | None, typer.Option(help="Available uplift at the supports, if the record does not state it.")
    ] = None,
    accept_unconfirmed: AcceptUnconfirmedOption = None,
    baseline: BaselineOption = None,
    drift: DriftOption = None,
    administration: AdministrationOption = None,
    report_number: ReportNumberOption = None,
) -> CommandOutput:
    """Assess a record by the rules of a profile.

    Examples:

    pantocheck assess run42.csv --profile acceptance-ac --wave-speed-m-s 122

    pantocheck assess simulated.toml --profile line-test --measured train.toml
    """
    options = build_options(
        out=out,
        formats=formats,
        language=language,
        trust=trust,
        decision=decision,
        drift_pct=drift,
        administration=read_stated_administration(administration, report_number),
    )
    folder = Path(options.out)
    report_formats = check_formats(options.formats)
    from pantocheck.conformance.comparison.profile_grading import assess_record  # `run` does not wait for it

    rules = load_profile(profile)
    own_limits = () if limits is None else read_limits(limits)
    facts = {"wave_speed_m_s": wave_speed_m_s, "uplift_space_mm": uplift_space_mm}
    given = {key: value for key, value in facts.items() if value is not None}
    line = validate_model(given, LineTable, "command line")
    earlier = None if baseline is None else read_baseline(baseline)
    assessed = load_assessed_record(record, rules, line)
    reference = None if measured is None else load_assessed_record(measured, rules, LineTable())
    pantographs = len(assessed.pantographs)
    for i, limit in enumerate(own_limits, 1):
        if limit.owner > pantographs:
            hint = f"The record has {pantographs}, numbered from 1 at the front."
            raise InputError(f"limits, key limit[{i}].pantograph", f"there is no pantograph {limit.owner}", hint)
    own_limits = repeat_limits(own_limits, pantographs)
    check_writable(folder)
    places = locate_record(record, profile, limits)
    participation = Participation(
        accepted_unconfirmed=tuple(accept_unconfirmed or ()), decision=parse_decision(options.decision)
    )
    results = assess_record(assessed, rules, options.trust, reference, own_limits, participation)
    results = results.model_copy(update={"administration": options.administration})
    with receive_signals(folder / FILES["json"], open_cases=0) as interruption:
        if earlier is not None and baseline is not None:
            write_all(results, folder, ("json",))  # kept if the comparison fails
            results = compare_with_baseline(results, earlier, options.drift_pct, baseline.name)
        files = write_all(results, folder, report_formats, places, options.language)
        remarks = remark_missing_formats(options.formats)
        return build_results_output(results, files, interruption.exit_code or EXIT_CODES[results.verdict], remarks)
