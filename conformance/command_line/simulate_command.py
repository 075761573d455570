"""`pantocheck simulate`: the record of one case, to look at or to compare with."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from contextlib import AbstractContextManager


def simulate_command(
    case: Annotated[str, typer.Argument(help="Id or path of one case, e.g. en50318-2002/250")],
    out: Annotated[Path, typer.Option(help="Record to write: NAME.csv or NAME.h5; NAME.toml is written beside it.")],
    system: Annotated[str, typer.Option(help="builtin, record:DIR or command:PROGRAM ARGUMENTS")] = "builtin",
) -> None:
    """Simulate a case and write its record.

    Example: pantocheck simulate en50318-2002/250 --out 250.csv
    """
    from pantocheck.conformance.cases.library import select_cases
    from pantocheck.conformance.command_line.console import console, escape_text
    from pantocheck.conformance.input_files.atomic_writing import check_writable
    from pantocheck.conformance.input_files.input_error import InputError
    from pantocheck.conformance.records.record_writing import check_record_path, write_record
    from pantocheck.conformance.results.outcome import Delivered, missing_record_reason
    from pantocheck.conformance.systems.system_choice import choose_system

    check_record_path(out)
    check_writable(out.parent)
    found = [one for one in select_cases([case]) if not one.is_static]
    if len(found) != 1:
        names = ", ".join(one.id for one in found) or "none that runs"
        raise InputError(f"case '{case}'", f"one case is simulated at a time, found {names}", "Name one of them.")
    chosen = choose_system(system)
    output = console()
    with output.status(f"simulating {found[0].id}") if output.is_terminal else _nothing():
        # A record holds one run: the reference simulator's refined one would be thrown away.
        outcome = getattr(chosen, "run_unrefined", chosen.run)(found[0])
    if not isinstance(outcome, Delivered) or outcome.record is None:
        reason = missing_record_reason(outcome)
        raise InputError(f"case '{found[0].id}'", f"no record: {reason}", "Choose another case or system.")
    sidecar = write_record(
        out,
        outcome.record,
        case=found[0].id,
        system={"name": chosen.name, "version": chosen.version},
        run=outcome.run.model_dump(),
    )
    output.print(escape_text(f"{out} and {sidecar.name}"))


def _nothing() -> "AbstractContextManager[None]":
    from contextlib import nullcontext

    return nullcontext()
