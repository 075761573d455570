"""`pantocheck readings`: values and verdicts of a record or case under every documented reading of its evaluation."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.cases_option import CasesOption, complete_case
from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, escape_text, indent_text, style_verdict
from pantocheck.conformance.app.commands.options import SetOption, choose_train_case
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import DEFAULT_READING
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes
from pantocheck.conformance.cases.library import load_entry
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.results_part import select_single
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.toml_file import read_toml
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.grading.reading_grades import judge_reading
from pantocheck.conformance.quantities.limit_text import format_graded, name_value
from pantocheck.conformance.records.record_reading import open_record
from pantocheck.conformance.results.results_format import CaseResult, Quantities
from pantocheck.conformance.runs.record_folder import RecordFolder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.system import Outcome

SUMMED_BANDS = ("rms_0_5_N", "rms_5_20_N")
"""Bands that share out the frequencies of `std_force_N`."""


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
    case, outcome = _open_subject(subject, changed or [], open_catalogue(folders or ()))
    result = grade_case(case, outcome, "provisional")
    if not result.quantities:
        raise InputError(f"case '{case.id}'", result.reason or "gives no value", "Give a record with a contact force.")
    turned = sum(bool(row.readings) for row in result.criteria)
    names = [DEFAULT_READING, *(reading.id for reading in result.readings)]
    count = "changes" if turned == 1 else "change"
    conclusion = f"{case.id}: {turned} of {len(result.criteria)} criteria {count} side between {len(names)} readings"
    return CommandOutput(
        escape_text(conclusion),
        {
            "case": case.id,
            "readings": [reading.model_dump(mode="json") for reading in result.readings],
            "criteria": [row.model_dump(mode="json") for row in result.criteria],
        },
        [*_list_tables(result, names), Text(), *_describe_readings(case, result)],
    )


def _open_subject(subject: str, changed: list[str], catalogue: Catalogue) -> tuple[Case, Outcome]:
    """Case, and the run of the reference simulator or the record to be graded."""
    path = Path(subject)
    if not path.is_file() or (path.suffix == ".toml" and "schema" not in read_toml(path, "file")):
        case = choose_train_case(subject, parse_changes(changed), catalogue)
        with follow_steps("simulation"):
            return case, ReferenceSimulator().run_unrefined(case)
    name = open_record(path).case
    if name is None or (entry := catalogue.find_id(name)) is None:
        found = "names no case" if name is None else f"names the case {name}, which is not at hand"
        hint = "Write the key case into the sidecar, or give the folder of the case by --cases."
        raise InputError(f"record '{path.name}', key case", found, hint)
    case = load_entry(entry, parse_changes(changed))
    return case, RecordFolder(path.stem, "", ((name, path.with_suffix(".toml")),)).run(case)


def _list_tables(result: CaseResult, names: list[str]) -> Iterator[RenderableType]:
    """Criteria by readings, and the sum of the bands beside the standard deviation."""
    table = build_table("criterion", "limits", *names, "mark", unbroken=("limits", *names, "mark"), right=names)
    for row in result.criteria:
        others = [judge_reading(row, reading) for reading in result.readings]
        cells = [(row.value, row.verdict), *others]
        pantograph = f", pantograph {row.pantograph}" if row.pantograph > 1 else ""
        table.add_row(
            escape_text(name_value(row.quantity, row.item) + pantograph),
            format_graded(row.value, row.lower, row.upper).bounds,
            *(
                Text.assemble(format_graded(value, row.lower, row.upper).value, " ", style_verdict(verdict))
                for value, verdict in cells
            ),
            "reading" if row.readings else "",
        )
    if table.row_count:
        yield table
        yield Text()
    sums = build_table("contact force, 0-20 Hz [N]", *names, unbroken=names, right=names)
    quantities = [result.quantities, *(reading.quantities for reading in result.readings)]
    for owner in sorted(set(result.quantities) - {"0"}):
        suffix = f", pantograph {owner}" if owner != "1" else ""
        parts = [_sum_bands(values, owner) for values in quantities]
        for label, texts in {
            "std_force_N": [format_graded(std, None, None).value for std, _ in parts],
            "root of the sum of squares of the bands": [format_graded(total, None, None).value for _, total in parts],
            "difference of both": [
                "-" if not std or total is None else f"{100 * (total / std - 1):+.1f} %" for std, total in parts
            ],
        }.items():
            sums.add_row(label + suffix, *texts)
    yield sums


def _sum_bands(quantities: Quantities, owner: str) -> tuple[float | None, float | None]:
    """Standard deviation up to 20 Hz, and the root of the sum of the squares of its bands [N]; None if not known."""
    values = quantities.get(owner, {})
    std, *bands = (select_single(values.get(name)) for name in ("std_force_N", *SUMMED_BANDS))
    return std, None if None in bands else math.hypot(*filter(None, bands))


def _describe_readings(case: Case, result: CaseResult) -> Iterator[RenderableType]:
    """Source and trust of each reading, and the reason where a record does not support it."""
    if not result.readings:
        yield escape_text("The case documents no further reading: its file has no [[reading]] table.")
    for reading, facts in zip(case.file.reading, result.readings, strict=False):
        reason = f" Not evaluated: {facts.reason}." if facts.reason else ""
        yield indent_text(f"{reading.id} ({reading.trust}, {facts.source}): {(reading.note or '').strip()}{reason}")
    yield escape_text(f"Reasons for the differences of bands and standard deviation: {DocumentationPage.READINGS}")
