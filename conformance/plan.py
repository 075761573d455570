"""Plans: the options of a run in a file, for a pipeline."""

import shlex
from pathlib import Path
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.cases.library import library_folder
from pantocheck.conformance.input_files.sourced_table import InputTable
from pantocheck.conformance.input_files.toml_file import read_model
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.systems.command.program_arguments import split_arguments

Names = Annotated[tuple[str, ...], Field(strict=False, max_length=1000)]


class Plan(InputTable):
    """What `pantocheck run` shall do; an option on the command line goes before the plan's."""

    cases: Annotated[Names, Field(description="ids, globs or paths of cases; left out: every case with limits")] = ()
    system: Annotated[str, Field(description="builtin, record:DIR or command:PROGRAM ARGUMENTS")] = "builtin"
    timeout_s: Annotated[float, Field(gt=0, description="time that a program may take for a case [s]")] = 600.0
    out: Annotated[str, Field(description="folder for the results")] = "report"
    formats: Annotated[Names, Field(description="what is written: html, pdf, json, junit, md, badge")] = (
        "html",
        "pdf",
        "json",
        "junit",
        "md",
    )
    trust: Annotated[Trust, Field(description="lowest trust of the limits that carry a verdict")] = "secondary"
    limits: Annotated[str | None, Field(description="file of limits to be laid over the cases")] = None
    baseline: Annotated[str | None, Field(description="results.json that values may not drift from")] = None
    drift_pct: Annotated[
        float, Field(gt=0, le=100, description="how far a value may be from that of the baseline [%]")
    ] = 1.0
    jobs: Annotated[int, Field(ge=1, le=256, description="cases that are run side by side")] = 1
    damping_study: Annotated[
        bool, Field(description="run every case also with benchmark, initial and updated damping")
    ] = False


def read_plan(path: Path) -> Plan:
    """Read a plan; paths in it are relative to its file.

    Raises
    ------
    InputError
        It cannot be read, or is wrong.
    """
    plan, folder = read_model(path, Plan, "plan"), path.parent
    kind, _, rest = plan.system.partition(":")
    system = plan.system
    if kind == "record":
        system = f"record:{_beside(folder, rest)}"
    elif kind == "command":
        system = f"command:{shlex.join(split_arguments(rest, folder))}"
    return plan.model_copy(
        update={
            "cases": tuple(str(folder / name) if name.endswith(".toml") else name for name in plan.cases),
            "system": system,
            "out": str(folder / plan.out),
            "baseline": None if plan.baseline is None else str(folder / plan.baseline),
            "limits": None if plan.limits is None else str(folder / plan.limits),
        }
    )


def _beside(folder: Path, records: str) -> Path:
    """A folder of records beside the plan, or else of the library."""
    beside = folder / records
    return Path(records) if not beside.is_dir() and (library_folder() / records).is_dir() else beside
