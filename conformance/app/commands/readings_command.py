"""`pantocheck readings`: values and verdicts of a record or case under every documented reading of its evaluation."""

import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import (
    FittedTable,
    build_table,
    escape_text,
    indent_text,
    style_verdict,
)
from pantocheck.conformance.app.commands.options import SetOption, choose_train_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.commands.quantities_table import select_main
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import DEFAULT_READING
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.criterion import Criterion
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.results_part import Number, select_single
from pantocheck.conformance.core.texts import DocumentationPage, count_noun
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.criterion_grading import skip_unlimited
from pantocheck.conformance.grading.reading_grades import judge_reading
from pantocheck.conformance.quantities.limit_text import format_graded, name_value
from pantocheck.conformance.records.record_reading import open_record
from pantocheck.conformance.results.results_format import CaseResult
from pantocheck.conformance.runs.record_folder import RecordFolder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Outcome

SUMMED_BANDS = ("rms_0_5_N", "rms_5_20_N")
"""Bands that share out the frequencies of `std_force_N`; their sum is the root of the sum of their squares."""


def readings_command(
    subject: Annotated[
        str,
        typer.Argument(
            metavar="RECORD|CASE",
            help="Record whose sidecar names its case, or id or path of a case, which is simulated.",
            autocompletion=complete_case,
        ),
    ],
    changed: SetOption = None,
    folders: CasesOption = None,
) -> CommandOutput:
    """Grade a record or case under every documented reading.

    A reading states filter, bands and analysis section. The keys of the case are the default reading; its [[reading]]
    tables are the others. Every limit is graded, whatever its trust. The mark `reading` stands beside a value that
    changes side between two readings. Nothing is judged: the exit code is 0.

    Examples:

    pantocheck readings en50318-2018/ac-simple/275

    pantocheck readings run.csv
    """
    simulate = ReferenceSimulator().run_unrefined
    case, outcome = open_subject(subject, changed or [], open_catalogue(folders or ()), simulate)
    result = grade_case(case, outcome, "provisional")
    if not result.quantities:
        raise InputError(f"case '{case.id}'", result.reason or "gives no value", "Give a record with a contact force.")
    turned = sum(bool(row.readings) for row in result.criteria)
    names = [DEFAULT_READING, *(reading.id for reading in result.readings)]
    count = "changes" if turned == 1 else "change"
    known = count_noun(len(names), "documented reading")
    conclusion = (
        f"{case.id}: {turned} of {len(result.criteria)} criteria {count} side between {known}, or with another contact"
    )
    return CommandOutput(
        escape_text(conclusion),
        {"case": case.id, "readings": result.readings, "criteria": result.criteria},
        [_build_table(result, names), Text(), *_describe_readings(case, result)],
    )


def open_subject(
    subject: str, changed: list[str], catalogue: Catalogue, simulate: Callable[[Case], Outcome]
) -> tuple[Case, Outcome]:
    """Case, and its simulation or the record to be graded."""
    path = Path(subject)
    if not path.is_file() or (path.suffix == ".toml" and "schema" not in read_toml(path, "file")):
        case = choose_train_case(subject, parse_changes(changed), catalogue)
        with follow_steps("simulation"):
            return case, simulate(case)
    name = open_record(path).case
    if name is None or (entry := catalogue.find_id(name)) is None:
        found = "names no case" if name is None else f"names the case {name}, which is not at hand"
        hint = "Write the key case into the sidecar, or give the folder of the case by --cases."
        raise InputError(f"record '{path.name}', key case", found, hint)
    case = load_entry(entry, parse_changes(changed))
    return case, RecordFolder(path.stem, "", ((name, path.with_suffix(".toml")),)).run(case)


def _build_table(result: CaseResult, names: list[str]) -> FittedTable:
    """Criteria, or main values without limits, by readings; and the sum of the bands against the standard deviation."""
    table = build_table("criterion", "limits", *names, "mark", unbroken=("limits", *names, "mark"), right=names)
    for row in result.criteria or _list_unlimited(result):
        cells = [(row.value, row.verdict), *(judge_reading(row, reading) for reading in result.readings)]
        texts = [(format_graded(value, row.lower, row.upper).value, verdict) for value, verdict in cells]
        table.add_row(
            escape_text(name_value(row.quantity, row.item) + _name_owner(row.pantograph)),
            format_graded(row.value, row.lower, row.upper).bounds,
            *(Text(f"{text} ") + style_verdict(verdict) if result.criteria else text for text, verdict in texts),
            "reading" if row.readings else "",
        )
    quantities = [result.quantities, *(reading.quantities for reading in result.readings)]
    for owner in sorted(set(result.quantities) - {"0"}):
        sums = [_sum_bands(values.get(owner, {})) for values in quantities]
        table.add_row(
            f"sum of bands, 0-20 Hz{_name_owner(int(owner))}",
            "",
            *(format_graded(total, None, None).value for total, _ in sums),
        )
        table.add_row(
            "  against std_force_N", "", *("-" if change is None else f"{change:+.1f} %" for _, change in sums)
        )
    return table


def _name_owner(number: int) -> str:
    return f", pantograph {number}" if number > 1 else ""


def _list_unlimited(result: CaseResult) -> list[Criterion]:
    """Main values of a case without limits."""
    return [
        skip_unlimited(name, "no limit", "", owner=int(owner), value=select_single(values[name]))
        for owner, values in result.quantities.items()
        for name in select_main(result.quantities)
        if name in values
    ]


def _sum_bands(values: Mapping[str, Number]) -> tuple[float | None, float | None]:
    """Root of the sum of squares of the bands [N], and its change against the standard deviation [%]."""
    std, *bands = (select_single(values.get(name)) for name in ("std_force_N", *SUMMED_BANDS))
    if None in bands:
        return None, None
    total = math.hypot(*filter(None, bands))
    return total, 100 * (total / std - 1) if std else None


def _describe_readings(case: Case, result: CaseResult) -> Iterator[RenderableType]:
    """Source and trust of each reading, and the reason where a record does not support it."""
    for row in result.criteria:
        for remark in row.readings:
            if remark.startswith("with "):
                yield indent_text(f"{row.quantity} of pantograph {row.pantograph}: {remark}")
    if not result.readings:
        yield escape_text("The case documents no further reading: its file has no [[reading]] table.")
    for reading, facts in zip(case.file.reading, result.readings, strict=False):
        reason = f" Not evaluated: {facts.reason}." if facts.reason else ""
        yield indent_text(f"{reading.id} ({reading.trust}, {facts.source}): {(reading.note or '').strip()}{reason}")
    yield escape_text(f"Reasons for the differences of bands and standard deviation: {DocumentationPage.READINGS}")
