"""`pantocheck identify`: modes of a line from mass-drop records."""

from pathlib import Path
from typing import Annotated

import typer

from pantocheck.conformance.command_line.console import console, escape_text, format_number
from pantocheck.conformance.command_line.file_list import print_files
from pantocheck.conformance.command_line.population_output import write_population
from pantocheck.conformance.identification.hand_placed_poles import read_poles
from pantocheck.conformance.identification.identification_analysis import analyse_identification
from pantocheck.conformance.identification.identify import identify_modes
from pantocheck.conformance.identification.mode import ModesFile
from pantocheck.conformance.identification.mode_export import MODE_FORMATS, select_mode_writer
from pantocheck.conformance.identification.population import identify_population
from pantocheck.conformance.identification.rounded_model import write_model
from pantocheck.conformance.input_files.atomic_writing import check_writable
from pantocheck.conformance.input_files.table_formats import TABLE_FORMATS, list_suffixes
from pantocheck.conformance.interface.identified_lines import write_identification
from pantocheck.conformance.mass_drops.drop_reading import read_drop_records
from pantocheck.conformance.reports.mass_drop.identification_report import collect_warnings


def identify_command(
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
) -> None:
    """Identify frequencies, damping ratios and mode shapes from mass-drop records.

    Records of one line (same spans and tensions) share their poles. Repeats of one drop are compared.

    Examples:

    pantocheck identify T1.h5 --out T1

    pantocheck identify T1.h5 T2.csv --out both --highest 6

    pantocheck identify T1.h5 --out T1 --export modes.csv --export modes.uff

    pantocheck identify T1.h5 T2.csv T3.uff --out all --each
    """
    output = console()
    exports = [(path, select_mode_writer(path)) for path in export or ()]
    start_poles = None if poles is None else read_poles(poles)
    drop_records = tuple(record for path in records for record in read_drop_records(path))
    for folder in (out, *(path.parent for path, _ in exports)):
        check_writable(folder)
    with output.status("reading") as status:
        inputs = (drop_records, highest, start_poles, lambda text: status.update(escape_text(text)))
        population = identify_population(*inputs) if each else None
        identifications = identify_modes(*inputs) if population is None else population.joint
        status.update("writing the report")
        lines = tuple(analyse_identification(identification) for identification in identifications)
        data = [line.model_dump(mode="json", by_alias=True) for line in lines]
        modes = tuple(mode for line in lines for mode in line.modes)
        write_model(out / "modes.json", ModesFile(modes))
        for path, write_modes in exports:
            write_modes(modes, path)
        document, files = write_identification(lines, out)
        population_lines = () if population is None else tuple(write_population(population, out))
    output.print(escape_text(document.header.headline))
    for group in (group for line in lines for group in line.groups):
        median = None if group.median_damping_ratio is None else 100 * group.median_damping_ratio
        output.print(
            escape_text(
                f"group {group.group}: {group.certain} of {group.modes} modes certain, "
                f"{group.from_Hz:.3f}-{group.to_Hz:.3f} Hz, median damping ratio {format_number(median)} %"
            )
        )
    for text in collect_warnings(data):
        output.print(escape_text(f"warning: {text}"))
    print_files([out / "modes.json", *files, *(path for path, _ in exports)])
    for text in population_lines:
        output.print(escape_text(text), soft_wrap=True)
