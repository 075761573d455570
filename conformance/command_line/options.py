"""Options of the commands that grade."""

from pathlib import Path
from typing import Annotated

import typer
from pydantic import ValidationError

from pantocheck.conformance.input_files.validation_messages import build_input_error
from pantocheck.conformance.plan import Plan, read_plan

BaselineOption = Annotated[
    Path | None, typer.Option(help="Earlier results.json; a value that drifts from it fails, apart from the limits.")
]


def build_options(plan: Path | None = None, **options: object) -> Plan:
    """Combine the options of the command line with those of a plan.

    Parameters
    ----------
    plan : Path or None
        File of the plan.
    options : object
        Options of the command line by their key in a plan; they replace those of the plan unless they are None.

    Raises
    ------
    InputError
        The plan cannot be read, or a value of the plan or of the command line is wrong.
    """
    base = read_plan(plan).model_dump() if plan is not None else {}
    try:
        return Plan.model_validate(base | {key: value for key, value in options.items() if value is not None})
    except ValidationError as error:
        raise build_input_error(error, Plan, "command line") from None


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Split names at commas; None stays None."""
    return None if text is None else tuple(name.strip() for name in text.split(",") if name.strip())
