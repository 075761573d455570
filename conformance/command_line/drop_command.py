"""`pantocheck drop`: the records of a case's mass drops, to be identified like measured ones."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

    from pantocheck.conformance.mass_drops.drop_record import DropRecord

SUFFIXES = (".uff", ".csv", ".h5")


def drop_command(
    case: Annotated[str, typer.Argument(help="Id or path of one case with a mass drop")],
    out: Annotated[Path, typer.Option(help="Record to write: NAME.uff, NAME.csv or NAME.h5.")],
    number: Annotated[
        int | None,
        typer.Option("--drop", help="Which drop of the case, from 1; left out: all, as NAME-1, NAME-2, ...", min=1),
    ] = None,
) -> None:
    """Simulate the mass drops of a case and write their records.

    Example: pantocheck drop vovan2015/mass-drop/updated --drop 1 --out drop.uff

    Then: pantocheck identify drop.uff --out modes
    """
    from rich.progress import Progress

    from pantocheck.conformance.cases.library import select_cases
    from pantocheck.conformance.command_line.console import console, escape_text
    from pantocheck.conformance.input_files.atomic_writing import check_writable
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.simulation.drop_simulation import require_mass_drop, simulate_drop

    if out.suffix.lower() not in SUFFIXES:
        raise InputError(str(out), f"format '{out.suffix}' cannot be written", f"Known are {', '.join(SUFFIXES)}.")
    check_writable(out.parent)
    found = [one for one in select_cases([case]) if one.file.mass_drop is not None]
    if len(found) != 1:
        names = ", ".join(one.id for one in found) or "none with a [mass_drop] table"
        raise InputError(f"case '{case}'", f"one case is simulated at a time, found {names}", "Name one of them.")
    drops = len(require_mass_drop(found[0]).drop)
    if number is not None and number > drops:
        raise InputError("--drop", f"there is no drop {number}", f"Case {found[0].id} has {drops}, numbered from 1.")
    output = console()
    with Progress(console=output, transient=True, disable=not output.is_terminal) as bar:
        for n in range(1, drops + 1) if number is None else [number]:
            task = bar.add_task(f"drop {n} of {drops}", total=1.0)
            made = simulate_drop(found[0], n, partial(_advance, bar, task))
            several = number is None and drops > 1
            path = out.with_name(f"{out.stem}-{n}{out.suffix}") if several else out
            _write(made.record, path)
            slack = made.decay.last_slack
            said = "no dropper slack after the release" if slack is None else f"a dropper slack until {slack:.2f} s"
            output.print(
                escape_text(f"{path}: {made.record.duration:g} s, {len(made.record.channels)} sensors, {said}")
            )


def _advance(bar: "Progress", task: "TaskID", share: float) -> None:
    bar.update(task, completed=share)


def _write(record: "DropRecord", path: Path) -> None:
    from pantocheck.conformance.mass_drops.drop_writing import write_drop_csv, write_drop_hdf5, write_drop_uff

    match path.suffix.lower():
        case ".uff":
            write_drop_uff(record, path)
        case ".csv":
            write_drop_csv(record, path)
        case _:
            write_drop_hdf5((record,), path)
