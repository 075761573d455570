"""Plans: the options of a run in a file, for a pipeline."""

from pathlib import Path
from typing import Annotated

from pantocheck.conformance.cases.base import Table
from pantocheck.conformance.cases.toml_file import read_model
from pantocheck.conformance.trust import Trust
from pydantic import Field

Names = Annotated[tuple[str, ...], Field(strict=False, max_length=1000)]


class Plan(Table):
    """What `pantocheck run` shall do; an option on the command line goes before the plan's."""

    cases: Annotated[Names, Field(description="ids, globs or paths of cases; left out: every case with limits")] = ()
    system: Annotated[str, Field(description="builtin or record:DIR")] = "builtin"
    out: Annotated[str, Field(description="folder for the results")] = "report"
    formats: Annotated[Names, Field(description="what is written: html, pdf, json, junit, md")] = (
        "html",
        "pdf",
        "json",
        "junit",
        "md",
    )
    trust: Annotated[Trust, Field(description="lowest trust of the limits that carry a verdict")] = "secondary"
    limits: Annotated[str | None, Field(description="file of limits to be laid over the cases")] = None
    jobs: Annotated[int, Field(ge=1, le=256, description="cases that are run side by side")] = 1
    damping_study: Annotated[
        bool, Field(description="run every case also with benchmark, initial and updated damping")
    ] = False


def read_plan(path: Path) -> Plan:
    """Read a plan; paths in it are relative to its file.

    Raises
    ------
    InputError : it cannot be read, or is wrong
    """
    plan, folder = read_model(path, Plan, "plan"), path.parent
    kind, _, rest = plan.system.partition(":")
    return plan.model_copy(
        update={
            "cases": tuple(str(folder / name) if name.endswith(".toml") else name for name in plan.cases),
            "system": f"record:{folder / rest}" if kind == "record" else plan.system,
            "out": str(folder / plan.out),
            "limits": None if plan.limits is None else str(folder / plan.limits),
        }
    )
