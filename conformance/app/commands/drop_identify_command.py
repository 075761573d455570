"""`pantocheck drop identify` and `drop fit`: modes of a line from mass-drop records, and a damping model from modes."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import typer
from rich.console import RenderableType

from pantocheck.conformance.app.commands.command_output import CommandOutput, Unwrapped
from pantocheck.conformance.app.commands.console import escape_text, format_number, indent_text
from pantocheck.conformance.app.commands.options import ElementOption, LineOption, read_line
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.identified_lines import (
    refuse_other_modes,
    write_damping_fit,
    write_identification,
)
from pantocheck.conformance.core.csv_table import write_csv_table
from pantocheck.conformance.core.files import check_writable
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.json_file import write_model
from pantocheck.conformance.core.measured_table import TABLE_FORMATS, list_suffixes
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.drops.damping_model import MODAL_GROUPS
from pantocheck.conformance.drops.damping_results import (
    FitOptions,
    WireCoefficients,
    build_damping_results,
    write_damping_toml,
)
from pantocheck.conformance.drops.damping_transfer import transfer_damping
from pantocheck.conformance.drops.drop_reading import read_drop_records
from pantocheck.conformance.drops.drop_record import DropRecord
from pantocheck.conformance.drops.forced_response import identify_forced
from pantocheck.conformance.drops.identification_analysis import analyse_identification
from pantocheck.conformance.drops.identification_plan import (
    IdentificationPlan,
    Method,
    exclude_channels,
    read_identification_plan,
    read_poles,
)
from pantocheck.conformance.drops.identify import group_by_line, identify_modes
from pantocheck.conformance.drops.mode_export import MODE_FORMATS, select_mode_writer
from pantocheck.conformance.drops.population import Population, identify_population
from pantocheck.conformance.drops.population_analysis import analyse_population
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.line.line_parameters import (
    MECHANICAL,
    PARAMETER_GROUPS,
    ParameterGroup,
    build_factor_covariance,
)
from pantocheck.conformance.pages.identification_page import collect_warnings
from pantocheck.conformance.pages.population_page import build_population_document
from pantocheck.conformance.pages.report_writers import remark_missing_formats, write_document
from pantocheck.conformance.results.damping_format import DampingResults
from pantocheck.conformance.results.identification_format import IdentificationFile, IdentifiedLine
from pantocheck.conformance.results.identified_modes import Mode, ModesFile, read_modes
from pantocheck.conformance.results.population_format import PooledGroup


def drop_identify_command(
    records: Annotated[
        list[Path],
        typer.Argument(help=f"Records: {list_suffixes(TABLE_FORMATS)}; a sidecar .toml of the same name is also read."),
    ],
    out: Annotated[Path, typer.Option(help="Folder for modes.json, identification.json, .html and .pdf.")],
    poles: Annotated[
        Path | None,
        typer.Option(
            help="Start poles placed by hand: TOML with [[pole]] frequency_Hz and damping_ratio, or a modes.json."
        ),
    ] = None,
    highest: Annotated[float, typer.Option(help="Highest frequency of a mode [Hz].", min=0.5, max=200.0)] = 10.0,
    export: Annotated[
        list[Path] | None,
        typer.Option(help=f"Also write the modes to this file ({', '.join(MODE_FORMATS)}); may be repeated."),
    ] = None,
    each: Annotated[
        bool, typer.Option("--each", help="Also identify every record on its own, and compare the tests: population.*")
    ] = False,
    method: Annotated[
        Method | None,
        typer.Option(help="finite-record (default): all poles together; classical: one pole for each spectral peak."),
    ] = None,
    plan: Annotated[
        Path | None,
        typer.Option(
            help="TOML with bands and their orders, excluded channels and stretches, poles to start from, keep or drop."
        ),
    ] = None,
) -> CommandOutput:
    """Identify the modes of a line from mass-drop records.

    Records of one line (same spans and tensions) share their poles. Repeats of one drop are compared. A record with a
    channel in N or kN (hammer, shaker) gives modes.json and frequency responses with their coherence.

    Examples:

    pantocheck drop identify T1.h5 --out T1

    pantocheck drop identify T1.h5 T2.csv --out both --highest 6

    pantocheck drop identify T1.h5 --out T1 --export modes.csv --export modes.uff

    pantocheck drop identify T1.h5 T2.csv T3.uff --out all --each

    pantocheck drop identify T1.h5 --plan plan.toml --out T1
    """
    choices = IdentificationPlan() if plan is None else read_identification_plan(plan)
    choices = choices if method is None else choices.model_copy(update={"method": method})
    exports = [(path, select_mode_writer(path)) for path in export or ()]
    start_poles = None if poles is None else read_poles(poles)
    drop_records = tuple(record for path in records for record in read_drop_records(path))
    for folder in (out, *(path.parent for path, _ in exports)):
        check_writable(folder)
    if any(record.force is not None for record in drop_records):
        unused = choices.model_dump(exclude={"highest_Hz", "exclude_channels"}, exclude_defaults=True)
        if unused or poles or each or exports:
            hint = "Leave out --poles, --each, --export and --method, and all keys but highest_Hz and exclude_channels."
            raise InputError("a record with a measured force", "does not use these options", hint)
        return _identify_driven(exclude_channels(drop_records, choices), choices.highest_Hz or highest, out)
    tasks = count_tasks(drop_records, "each" if each else "joint")
    with follow_steps("identification", tasks) as progress:
        inputs = (drop_records, highest, start_poles, progress.begin_task, choices)
        population = identify_population(*inputs) if each else None
        identifications = identify_modes(*inputs) if population is None else population.joint
        progress.begin_task("report")
        lines = tuple(analyse_identification(identification) for identification in identifications)
        modes = tuple(mode for line in lines for mode in line.modes)
        write_model(out / "modes.json", ModesFile(modes))
        for path, write_modes in exports:
            write_modes(modes, path)
        document, files = write_identification(lines, out)
        population_lines, population_files = ((), ()) if population is None else write_population(population, out)
    return CommandOutput(
        escape_text(document.header.headline),
        IdentificationFile(lines=lines),
        [
            *_list_groups(lines),
            *(indent_text(text, "warning: ") for text in collect_warnings(lines)),
            *map(escape_text, population_lines),
        ],
        files=[out / "modes.json", *files, *(path for path, _ in exports), *population_files],
        remarks=remark_missing_formats(),
    )


def _identify_driven(records: Sequence[DropRecord], highest: float, out: Path) -> CommandOutput:
    """Identify records with a measured force; writes modes.json and the frequency responses of each record."""
    modes: list[Mode] = []
    files, lines = [out / "modes.json"], []
    with follow_steps("identification", len(records)) as progress:
        for number, record in enumerate(records, 1):
            progress.begin_task(record.name)
            found = identify_forced(record, highest)
            modes += found.modes
            files.append(out / f"responses-{number}.csv")
            names, values = found.responses.tabulate([record.channels[c].name for c in record.along("z")])
            write_csv_table(files[-1], names, values, 6)
            at_modes = found.responses.coherence_at([mode.frequency_Hz for mode in found.modes])
            certain = sum(mode.certain for mode in found.modes)
            lines.append(
                f"{record.name}: {certain} of {len(found.modes)} modes certain, squared residual "
                f"{found.misfit:.2f} times noise, coherence at the modes {at_modes.min():.2f} to {at_modes.max():.2f}"
            )
    write_model(out / "modes.json", ModesFile(tuple(modes)))
    headline = f"{len(modes)} modes identified from {count_noun(len(records), 'record')} with a measured force"
    return CommandOutput(escape_text(headline), ModesFile(tuple(modes)), [*map(escape_text, lines)], files=files)


def count_tasks(records: Sequence[DropRecord], extent: Literal["each", "joint"]) -> int:
    """Number of tasks that an identification reports: preparation of records, poles, uncertainty, and the report."""
    lines = [len(line) for line in group_by_line(tuple(records))]
    if extent == "joint":
        return sum(line + 2 for line in lines) + 1
    return sum(3 * line + (2 if line > 1 else 0) for line in lines) + 1


def _list_groups(lines: Sequence[IdentifiedLine]) -> Iterator[RenderableType]:
    """Modes and median damping of every group."""
    for group in (group for line in lines for group in line.groups):
        median = None if group.median_damping_ratio is None else 100 * group.median_damping_ratio
        yield escape_text(
            f"group {group.group}: {group.certain} of {group.modes} modes certain, "
            f"{group.from_Hz:.3f}-{group.to_Hz:.3f} Hz, median damping ratio {format_number(median)} %"
        )


# Output of `pantocheck drop identify --each`: population.json, its pages, and lines for the terminal.
def write_population(population: Population, out: Path) -> tuple[tuple[str, ...], list[Path]]:
    """Write population.json, .html and .pdf to a folder; returns lines for the terminal, and the written files."""
    content = analyse_population(population)
    document = build_population_document(content)
    write_model(out / "population.json", content)
    pages = write_document(document, out / "population")
    warnings = (f"warning: {text}" for text in content.warnings)
    lines = (document.header.headline, *map(_format_group, content.groups), *warnings)
    return lines, [out / "population.json", *pages]


def _format_group(group: PooledGroup) -> str:
    joint = None if group.joint_median is None else 100 * group.joint_median
    return (
        f"group {group.group}: median over tests {format_number(100 * group.median)} % "
        f"({format_number(100 * group.interval[0])}-{format_number(100 * group.interval[1])} %), joint result "
        f"{format_number(joint)} %, outliers: {group.outliers_above} above, {group.outliers_below} below"
    )


# `pantocheck drop fit`: damping model of a line from identified modes.
TRANSFER_FILE = "transfer.csv"


def drop_fit_command(
    modes: Annotated[Path, typer.Argument(help="modes.json of `pantocheck drop identify`.")],
    line: LineOption,
    out: Annotated[
        Path, typer.Option(help="Folder for damping.toml, damping_with_modal.toml, damping.json, .html and .pdf.")
    ],
    element: ElementOption = 0.5,
    free: Annotated[
        str,
        typer.Option(
            help="Properties of the line that are fitted as well, separated by commas: "
            f"{', '.join(PARAMETER_GROUPS)}; none: the line is exact."
        ),
    ] = "tensions",
    wires: Annotated[
        WireCoefficients,
        typer.Option(help="separate: each wire has its own coefficients; common: both wires have the same."),
    ] = "separate",
    modal_groups: Annotated[
        int,
        typer.Option(
            help="Groups of span modes with a band of modal damping in damping_with_modal.toml.", min=1, max=8
        ),
    ] = MODAL_GROUPS,
    other_line: Annotated[
        bool,
        typer.Option("--other-line", help="Permit a line that differs from that of the record; the result is marked."),
    ] = False,
    transfer: Annotated[
        str | None,
        typer.Option(help="Line of the same wire materials: transfer.csv has its damping ratios with their intervals."),
    ] = None,
) -> CommandOutput:
    """Fit a damping model of a line to identified modes.

    The model is Rayleigh damping per component, with and without modal damping. The tensions are fitted together with
    it, about the stated values with their tolerances ([tolerance] of the line file, or 1 %). The report states which
    coefficients the modes determine, and a line that the frequencies contradict. A line whose spans, tensions or wires
    at the sensors differ from those of the record is refused.

    Example: pantocheck drop fit T1/modes.json --line my-line.toml --out T1
    """
    measured = read_line(line)
    identified, catenary = read_modes(modes), build_catenary(measured)
    if not other_line:
        refuse_other_modes(identified, catenary, modes.name)
    check_writable(out)
    with follow_steps("damping fit", 2) as progress:
        progress.begin_task("modes of the line")
        tolerances = build_factor_covariance(measured, MECHANICAL)
        options = FitOptions(wires, modal_groups, choose_groups(free), tolerances)
        results = build_damping_results(identified, catenary, element, modes.name, options)
        progress.begin_task("report")
        document, files = write_damping_fit(results, out)
    transferred = [] if transfer is None else _write_transfer(results, (measured, read_line(transfer)), element, out)
    return CommandOutput(
        escape_text(document.header.headline),
        results,
        [
            *(indent_text(text, "warning: ") for text in results.warnings),
            Unwrapped(escape_text(write_damping_toml(results)).plain),
            *transferred,
        ],
        files=[*files, *([] if transfer is None else [out / TRANSFER_FILE])],
        remarks=remark_missing_formats(),
    )


def choose_groups(text: str) -> tuple[ParameterGroup, ...]:
    """Groups of properties from a list with commas, or none.

    Raises:
        InputError: A name is not a group.
    """
    names = [] if text.strip() == "none" else [name.strip() for name in text.split(",")]
    if unknown := [name for name in names if name not in PARAMETER_GROUPS]:
        raise InputError("--free", f"{unknown[0][:80]!r} is not known", f"Choose of {', '.join(PARAMETER_GROUPS)}.")
    return tuple(group for group in PARAMETER_GROUPS if group in names)


def _write_transfer(
    results: DampingResults, lines: tuple[LineFile, LineFile], element: float, out: Path
) -> list[RenderableType]:
    """Write the damping ratios of the second line by the fit on the first one; returns lines for the terminal."""
    found = transfer_damping(results, *lines, element)
    names = ["frequency_Hz", "damping_ratio", "half_width_at_least_95"]
    write_csv_table(out / TRANSFER_FILE, names, np.column_stack([found.frequency, found.ratio, found.half_width]), 6)
    width = 100 * float(np.median(found.half_width / found.ratio))
    return [
        escape_text(f"transfer: {found.frequency.size} modes, intervals of at least 95 %: +-{width:.0f} % (median)"),
        *(indent_text(text, "the rule does not hold: ") for text in found.violations),
    ]
