"""Options that commands which grade have in common, checked in one way."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from pantocheck.conformance.plan import Plan

BaselineOption = Annotated[
    Path | None, typer.Option(help="Earlier results.json; a value that drifts from it fails, limits apart.")
]


def build_options(plan: Path | None = None, **given: object) -> "Plan":
    """The options of the command line, laid over those of a plan.

    Parameters
    ----------
    plan : Path or None
        Its file, if there is one.
    given : object
        By key of a plan; what is None was not given.

    Raises
    ------
    InputError
        The plan cannot be read or is wrong, or an option is wrong.
    """
    from pydantic import ValidationError

    from pantocheck.conformance.input_files.validation_messages import build_input_error
    from pantocheck.conformance.plan import Plan, read_plan

    base = read_plan(plan).model_dump() if plan is not None else {}
    try:
        return Plan.model_validate(base | {key: value for key, value in given.items() if value is not None})
    except ValidationError as error:
        raise build_input_error(error, Plan, "command line") from None


def split_names(listed: str | None) -> tuple[str, ...] | None:
    """Names that an option lists with commas between them; None if it was not given."""
    return None if listed is None else tuple(name.strip() for name in listed.split(",") if name.strip())
