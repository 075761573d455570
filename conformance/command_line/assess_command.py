"""`pantocheck assess`: a record by the rules of a profile."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pantocheck.conformance.command_line.options import BaselineOption, build_options, split_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pantocheck.conformance.cases.limits import Limit
    from pantocheck.conformance.records.record_sidecar import LineTable


def assess_command(
    record: Annotated[Path, typer.Argument(help="Record: its sidecar, its table, or a summary record.")],
    profile: Annotated[
        str,
        typer.Option(
            help="acceptance-ac, acceptance-dc-3kv, acceptance-dc-1500v, line-test, or the path of your own .toml ."
        ),
    ],
    measured: Annotated[
        Path | None, typer.Option(help="Measured record to compare with, for a profile such as line-test.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("report"),
    formats: Annotated[
        str, typer.Option(help="What is written: html, pdf, json, junit, md, badge.")
    ] = "html,pdf,json,junit,md",
    trust: Annotated[
        str, typer.Option(help="Lowest trust of rules that count: primary, secondary or provisional.")
    ] = "secondary",
    limits: Annotated[Path | None, typer.Option(help="TOML file of your own limits, in place of the rules.")] = None,
    wave_speed_m_s: Annotated[
        float | None, typer.Option(help="Wave speed of the contact wire, if the record does not say it.")
    ] = None,
    uplift_space_mm: Annotated[
        float | None, typer.Option(help="Space for uplift at the supports, if the record does not say it.")
    ] = None,
    baseline: BaselineOption = None,
    drift: Annotated[float, typer.Option(help="How far a value may drift from the baseline, in percent.")] = 1.0,
) -> None:
    """Assess a record, simulated or measured, by a profile: acceptance of a line, or a line test.

    Examples:

    pantocheck assess run42.csv --profile acceptance-ac --wave-speed-m-s 122 --out report

    pantocheck assess simulated.toml --profile line-test --measured train.toml --trust provisional
    """
    from pantocheck.conformance.cases.profile_file import load_profile
    from pantocheck.conformance.command_line.results_output import EXIT_CODES, print_results
    from pantocheck.conformance.grading.assessed_record import load_assessed_record
    from pantocheck.conformance.grading.baseline import compare_with_baseline
    from pantocheck.conformance.grading.profile_grading import assess_record as assessed
    from pantocheck.conformance.input_files.atomic_writing import check_writable
    from pantocheck.conformance.records.record_sidecar import LineTable
    from pantocheck.conformance.reports.formats.report_writers import check_formats, write_all
    from pantocheck.conformance.results.results_reading import read_results

    options = build_options(out=str(out), formats=split_names(formats), trust=trust, drift_pct=drift)
    written = check_formats(options.formats)
    rules = load_profile(profile)
    own = () if limits is None else _limits(limits)
    line = _line(wave_speed_m_s=wave_speed_m_s, uplift_space_mm=uplift_space_mm)
    earlier = None if baseline is None else read_results(baseline)
    check_writable(out)
    subject = load_assessed_record(record, rules, line)
    other = None if measured is None else load_assessed_record(measured, rules, LineTable())
    _check_owners(own, len(subject.pantographs))
    results = assessed(subject, rules, options.trust, other, own)
    if earlier is not None and baseline is not None:
        results = compare_with_baseline(results, earlier, options.drift_pct, baseline.name)
    print_results(results, write_all(results, out, written))
    raise typer.Exit(EXIT_CODES[results.verdict])


def _line(**given: float | None) -> "LineTable":
    from pydantic import ValidationError

    from pantocheck.conformance.input_files.validation_messages import build_input_error
    from pantocheck.conformance.records.record_sidecar import LineTable

    try:
        return LineTable.model_validate({key: value for key, value in given.items() if value is not None})
    except ValidationError as error:
        raise build_input_error(error, LineTable, "command line") from None


def _limits(path: Path) -> "Sequence[Limit]":
    from pantocheck.conformance.cases.library import read_limits

    return read_limits(path)


def _check_owners(limits: "Sequence[Limit]", pantographs: int) -> None:
    from pantocheck.conformance.input_files.input_error import InputError

    for i, limit in enumerate(limits, 1):
        if limit.owner > pantographs:
            raise InputError(
                f"limits, key limit[{i}].pantograph",
                f"there is no pantograph {limit.owner}",
                f"The record has {pantographs}, numbered from 1 at the front.",
            )
