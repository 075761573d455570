"""`pantocheck pantograph fit`: chain of lumped masses from measured frequency responses."""

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
import tomli_w
import typer
from rich.console import RenderableType
from rich.text import Text

from pantocheck.conformance.app.commands.command_output import CommandOutput
from pantocheck.conformance.app.commands.console import build_table, format_number, indent_text
from pantocheck.conformance.app.commands.measured_comparison_command import write_comparison_files
from pantocheck.conformance.app.commands.options import ResponsesArgument
from pantocheck.conformance.app.commands.progress_display import follow_steps
from pantocheck.conformance.app.notebook.fitted_pantograph import (
    CONTACT_STIFFNESS_N_M,
    build_fitted_pantograph,
    build_transfer_pantograph,
)
from pantocheck.conformance.comparison.pantograph_fit import CHAIN_KEYS, name_parameter
from pantocheck.conformance.core.array_types import RealArray
from pantocheck.conformance.core.files import check_writable, write_atomically
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.texts import count_noun
from pantocheck.conformance.pages.report_writers import remark_missing_formats
from pantocheck.conformance.pantograph.chain_fit import MASS_COUNTS, FitTask, fit_chains, join_responses
from pantocheck.conformance.pantograph.response_record import read_response
from pantocheck.conformance.pantograph.transfer_function import FittedTransfer, fit_transfer_function
from pantocheck.conformance.results.pantograph_fit_format import PantographFit


def pantograph_fit_command(
    responses: ResponsesArgument,
    out: Annotated[Path, typer.Option(help="Pantograph file to write; the reports stand beside it.")],
    masses: Annotated[
        int | None,
        typer.Option(
            help="Number of masses.", min=MASS_COUNTS[0], max=MASS_COUNTS[-1], show_default="by information criterion"
        ),
    ] = None,
    bending_modes: Annotated[
        int, typer.Option(help="Number of bending modes of the head beside the chain.", min=0, max=4)
    ] = 0,
    pole_pairs: Annotated[
        int | None,
        typer.Option(
            help="Pairs of poles of a transfer function in place of a chain.", min=1, max=20, show_default=False
        ),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY.NUMBER=VALUE", help="Fixed value, e.g. masses_kg.3=7.5; repeat for several."),
    ] = None,
    band: Annotated[
        str | None, typer.Option(metavar="LOW:HIGH", help="Frequencies of the fit [Hz].", show_default="all rows")
    ] = None,
    title: Annotated[str, typer.Option(help="Title of the pantograph.")] = "Fitted pantograph",
    contact_stiffness: Annotated[
        float, typer.Option("--contact-stiffness-N-m", help="Contact of the file, not part of a response.", min=1.0)
    ] = CONTACT_STIFFNESS_N_M,
) -> CommandOutput:
    """Fit a chain of lumped masses to measured responses.

    Chains of two, three and four masses are fitted. The report shows intervals and states which parameters the band
    does not determine. With --pole-pairs, a stable and passive transfer function is fitted.

    Example: pantocheck pantograph fit at-55N.csv at-70N.csv --masses 3 --out my-pantograph.toml
    """
    records = tuple(read_response(path) for path in responses)
    if out.suffix != ".toml":
        raise InputError("--out", f"{out.name!r} is not a TOML file", "Give a name that ends in .toml .")
    check_writable(out.parent)
    if pole_pairs is not None:
        if masses is not None or fix or bending_modes:
            hint = "Leave out --masses, --fix and --bending-modes."
            raise InputError("--pole-pairs", "is given together with options of a chain", hint)
        with follow_steps("fitting"):
            transfer = fit_transfer_function(join_responses(records, _parse_band(band)), pole_pairs)
            tables, comparison = build_transfer_pantograph(records, transfer, title, contact_stiffness)
            write_atomically(out, tomli_w.dumps(tables).encode())
            files = [out, *write_comparison_files(comparison, out.with_name(f"{out.stem}-fit"))]
        poles = transfer.pole.size + int(np.count_nonzero(transfer.pole.imag))
        return CommandOutput(
            Text(f"Transfer function of {count_noun(poles, 'pole')} fitted"),
            comparison,
            [Text(_describe_transfer(transfer))],
            files=files,
            remarks=remark_missing_formats(),
        )
    task = FitTask(_parse_band(band), _parse_fixed(fix or [], masses), bending_modes)
    with follow_steps("fitting"):
        selection = fit_chains(records, task)
        fit = build_fitted_pantograph(records, selection, masses or selection.best, title, contact_stiffness)
        files = fit.write(out)
    chain = f"Chain of {count_noun(fit.report.masses, 'mass', 'masses')}"
    conclusion = f"{chain} fitted to {count_noun(len(records), 'response')}"
    details = [*_describe_fit(fit.report)]
    return CommandOutput(Text(conclusion), fit.report, details, files=files, remarks=remark_missing_formats())


def _describe_transfer(fit: FittedTransfer) -> str:
    """Deviation from the responses, and distance to the nearest passive model."""
    text = f"RMS deviation {100 * fit.deviation:.2g} %; every pole is stable"
    if not fit.distance:
        return f"{text}, and the fit is passive"
    return f"{text}; the residues are those of the nearest passive model, {100 * fit.distance:.2g} % from the fit"


def _parse_band(text: str | None) -> tuple[float, float]:
    """Lowest and highest frequency of the fit [Hz]."""
    if text is None:
        return 0.0, math.inf
    try:
        low, high = map(float, text.split(":"))
    except ValueError:
        low, high = math.nan, math.nan
    if not 0 <= low < high:
        raise InputError("--band", f"{text[:40]!r} is not a band", "Give LOW:HIGH in hertz, e.g. 0.5:50.")
    return low, high


def _parse_fixed(texts: list[str], masses: int | None) -> RealArray | None:
    """Fixed values of a chain, (3, n), NaN: free; None: all are free, and the number of masses is not chosen."""
    if not texts:
        return None
    if masses is None:
        raise InputError("--fix", "is given without a number of masses", "Give --masses as well.")
    fixed = np.full((3, masses), np.nan)
    names = {name_parameter(key, n + 1): (row, n) for row, key in enumerate(CHAIN_KEYS) for n in range(masses)}
    counts = Counter(text.split("=", 1)[0] for text in texts)
    for text in texts:
        name, _, value = text.partition("=")
        if name not in names:
            raise InputError("--fix", f"there is no parameter {name[:40]!r}", suggest_names(name, list(names)))
        if counts[name] > 1:
            raise InputError("--fix", f"{name} is given {counts[name]} times", "Fix each parameter once.")
        fixed[names[name]] = _parse_value(name, value)
    return fixed


def _parse_value(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    smallest_allowed = value > 0 or (value == 0 and not name.startswith("masses_kg"))
    if not (smallest_allowed and value < 1e9):
        raise InputError("--fix", f"{name} has the value {text[:40]!r}", "Give a number, e.g. masses_kg.3=7.5.")
    return value


def _describe_fit(report: PantographFit) -> Iterator[RenderableType]:
    """Candidates, parameters and caveats."""
    numbers = ("RMS deviation %", "variance ratio", "BIC")
    candidates = build_table("masses", *numbers, title="Chains", right=numbers)
    for item in report.candidates:
        values = (item.complex_deviation_pct, item.variance_ratio, item.information_criterion)
        mark = " (chosen)" if item.masses == report.masses else ""
        candidates.add_row(f"{item.masses}{mark}", *(format_number(value) for value in values))
    yield candidates
    parameters = build_table("parameter", "value", "± 95 %", "", right=("value", "± 95 %"))
    for parameter in report.parameters:
        state = parameter.determination.replace("_", " ")
        name = name_parameter(parameter.key, parameter.number)
        parameters.add_row(name, format_number(parameter.value), format_number(parameter.half_width, 2), state)
    yield parameters
    for warning in report.warnings:
        yield indent_text(warning, "warning: ")
