"""`pantocheck assess`: grading of a record by the rules of a profile."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.interruption import receive_signals
from pantocheck.conformance.app.commands.options import (
    AcceptUnverifiedOption,
    AdministrationOption,
    BaselineOption,
    DriftOption,
    FormatsOption,
    OutOption,
    ReportNumberOption,
    TrustOption,
    build_options,
    state_administration,
)
from pantocheck.conformance.app.commands.results_output import EXIT_CODES, build_results_output
from pantocheck.conformance.cases.library import read_limits
from pantocheck.conformance.cases.limits import spread_limits
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import validate_model
from pantocheck.conformance.execution.plan import locate_record
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.baseline import compare_with_baseline, read_baseline
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_all
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.report_files import FILES, check_formats


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
    trust: TrustOption = None,
    limits: Annotated[
        Path | None, typer.Option(help="TOML file of your own limits, which replace the rules of the profile.")
    ] = None,
    wave_speed_m_s: Annotated[
        float | None, typer.Option(help="Wave propagation speed of the contact wire, if the record does not state it.")
    ] = None,
    uplift_space_mm: Annotated[
        float | None, typer.Option(help="Available uplift at the supports, if the record does not state it.")
    ] = None,
    accept_unverified: AcceptUnverifiedOption = None,
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
        trust=trust,
        drift_pct=drift,
        administration=state_administration(administration, report_number),
    )
    folder = Path(options.out)
    report_formats = check_formats(options.formats)
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
    own_limits = spread_limits(own_limits, pantographs)
    check_writable(folder)
    places = locate_record(record, profile, limits)
    participation = Participation(accepted_unverified=tuple(accept_unverified or ()))
    results = assess_record(assessed, rules, options.trust, reference, own_limits, participation)
    results = results.model_copy(update={"administration": options.administration})
    with receive_signals(folder / FILES["json"], open_cases=0) as interruption:
        if earlier is not None and baseline is not None:
            write_all(results, folder, ("json",))  # kept if the comparison fails
            results = compare_with_baseline(results, earlier, options.drift_pct, baseline.name)
        files = write_all(results, folder, report_formats, places)
        remarks = remark_missing_formats(options.formats)
        return build_results_output(results, files, interruption.exit_code or EXIT_CODES[results.verdict], remarks)
