"""Campaign files: base cases, variations of their inputs, sampled inputs, links, conditions and execution."""

import re
import tomllib
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.campaigns.distributions import Distribution
from pantocheck.conformance.campaigns.run_traces import StoredTraces
from pantocheck.conformance.cases.input_changes import build_change, parse_value
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.sourced_table import (
    InputTable,
    Positive,
    Problems,
    SourcedTable,
    cross_check,
    validation_problem,
)
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.runs.system_choice import TIMEOUT_S

MOST_RUNS = 10_000_000
"""Largest number of runs of a campaign: at 10 ms per run more than a day."""

Key = Annotated[
    str,
    Field(min_length=1, max_length=200, description='key of an input as in --set, e.g. "line.contact_wire.mass_kg_m"'),
]
InputValue = bool | int | float | str | list[Any]
Values = Annotated[tuple[InputValue, ...], Field(strict=False, min_length=1, max_length=100_000)]


class ValueRange(InputTable):
    """Equidistant values; the end is included if a step reaches it."""

    start: int | float
    """First value."""
    stop: int | float
    """Last value, if a step reaches it."""
    step: Annotated[int | float, Field(gt=0)]
    """Distance of the values."""

    @cross_check
    def _check_length(self) -> Problems:
        if self.stop < self.start:
            yield validation_problem("stop", f"{self.stop:g} is less than start = {self.start:g}", "Swap them.")
        elif (self.stop - self.start) / self.step >= MOST_RUNS:
            yield validation_problem("step", f"gives more than {MOST_RUNS} values", "Give a larger step.")


class ValueVariation(SourcedTable):
    """Variation of one key over listed values."""

    key: Key
    values: Values
    """Values of the key, in the types of TOML."""


class RangeVariation(SourcedTable):
    """Variation of one key over equidistant values."""

    key: Key
    range: ValueRange


class ColumnVariation(SourcedTable):
    """Variation of several keys together: the first values of all of them, then the second values."""

    columns: Annotated[dict[Key, Values], Field(min_length=1)]
    """Values of each key; all lists have the same length."""

    @cross_check
    def _check_lengths(self) -> Problems:
        lengths = {key: len(values) for key, values in self.columns.items()}
        if len(set(lengths.values())) > 1:
            found = ", ".join(f"{key}: {length}" for key, length in lengths.items())
            yield validation_problem("columns", f"lists of different length ({found})", "Give one value per run.")


class TableVariation(SourcedTable):
    """Variation by a table of designs: one row per design, one column per key."""

    table: Annotated[str, Field(min_length=1, max_length=500)]
    """CSV file, relative to the campaign; keys in its first row."""


_KINDS = {"range": "RangeVariation", "columns": "ColumnVariation", "table": "TableVariation"}


def _name_variation(variation: Any) -> str:
    """Name of the model of a variation, which pydantic validates and reports alone."""
    if isinstance(variation, dict):
        return next((kind for key, kind in _KINDS.items() if key in variation), "ValueVariation")
    return type(variation).__name__


InputVariation = Annotated[
    Annotated[ValueVariation, Tag("ValueVariation")]
    | Annotated[RangeVariation, Tag("RangeVariation")]
    | Annotated[ColumnVariation, Tag("ColumnVariation")]
    | Annotated[TableVariation, Tag("TableVariation")],
    Discriminator(_name_variation),
]
"""Values of one key, or of several keys that vary together."""


class SampledInput(SourcedTable):
    """Random input with its distribution."""

    key: Key
    distribution: Distribution


class InputSampling(InputTable):
    """Random designs of several inputs; the seed makes them repeatable."""

    method: Literal["latin-hypercube", "sobol", "random", "saltelli"]
    """Latin-hypercube; sobol: scrambled sequence of a power of two runs; random: independent; saltelli: designs for
    Sobol indices.
    """
    runs: Annotated[int, Field(ge=1, le=1_000_000)]
    """Number of designs; of saltelli: of the first of its k + 2 sets."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 0
    """Seed of the generator."""
    input: Annotated[tuple[SampledInput, ...], Field(strict=False, min_length=1, max_length=1000)]

    @cross_check
    def _check_balance(self) -> Problems:
        if self.method in ("sobol", "saltelli") and self.runs & (self.runs - 1):
            less = 2 ** (self.runs.bit_length() - 1)
            hint = f"A Sobol sequence is balanced for powers of two, e.g. {less} or {2 * less}."
            yield validation_problem("runs", f"{self.runs} is not a power of two", hint)


class InputLink(InputTable):
    """Input that follows another varied input: factor times its value plus offset."""

    key: Key
    follows: Key
    factor: float = 1.0
    """Factor of the followed value."""
    offset: float = 0.0
    """Summand, in the unit of `key`."""


ClusterKind = Literal["slurm", "pbs", "sge", "lsf", "htcondor", "oar", "moab"]
"""Batch system of a cluster."""


class Execution(InputTable):
    """Execution of a campaign; it has no influence on the results of a run."""

    workers: Annotated[int | None, Field(ge=1, le=100_000)] = None
    """Number of processes, or of jobs of a cluster; default: processors."""
    scheduler: Annotated[str | None, Field(max_length=500)] = None
    """Address of a running scheduler of Dask, e.g. tcp://host:8786."""
    cluster: ClusterKind | None = None
    """Batch system to which workers are submitted."""
    cluster_options: Annotated[dict[str, InputValue], Field(max_length=100)] = Field(default_factory=dict)
    """Options of the jobs as in dask-jobqueue, e.g. walltime = "02:00:00"."""
    max_failed_share: Annotated[float, Field(ge=0, le=1)] = 0.9
    """Share of failed runs above which the campaign stops early; 1: never."""
    time_budget_s: Annotated[float | None, Field(gt=0)] = None
    """Time after which no further run is started [s]."""
    run_time_limit_s: Annotated[float | None, Field(gt=0)] = None
    """Time after which a single run fails [s]."""
    traces: StoredTraces = "none"
    """Runs whose curves of force and uplift are stored: none, failing (verdict fail), or all."""
    timeout_s: Positive = TIMEOUT_S
    """Time limit of a program for a case [s]."""

    @property
    def is_local(self) -> bool:
        """Whether the runs are executed by processes of this machine."""
        return self.scheduler is None and self.cluster is None

    @cross_check
    def _check_cluster(self) -> Problems:
        if self.scheduler is not None and self.cluster is not None:
            yield validation_problem("scheduler", "is given together with cluster", "Give either scheduler or cluster.")


Texts = Annotated[tuple[str, ...], Field(strict=False, max_length=1000)]


class CampaignFile(InputTable):
    """Campaign: every case with every combination of the variations, on every system."""

    title: Annotated[str, Field(max_length=200)] = "Campaign"
    """Title in reports."""
    cases: Annotated[Texts, Field(min_length=1)]
    """Ids, globs or paths of the base cases, relative to the campaign."""
    case_folders: Texts = ()
    """Folders with further cases, whose ids begin with own/, relative to the campaign."""
    set: Texts = ()
    """Inputs changed in all runs, e.g. "speed_km_h=300"."""
    pantograph: Texts = ()
    """Pantograph files or FMUs in place of those of the cases, as `pantograph` of a plan."""
    vary: Annotated[tuple[InputVariation, ...], Field(strict=False, max_length=100)] = ()
    """Variations, combined as a grid."""
    sampling: InputSampling | None = None
    """Random designs, combined with the grid."""
    link: Annotated[tuple[InputLink, ...], Field(strict=False, max_length=1000)] = ()
    conditions: Texts = ()
    """Conditions on varied inputs, e.g. "speed_km_h <= 320"; designs that break one are left out."""
    systems: Annotated[Texts, Field(min_length=1)] = ("builtin",)
    """Builtin, record:DIR or command:PROGRAM ARGUMENTS; {design} in it is the number of the design."""
    refined: bool = False
    """true: runs on two other meshes, for the uncertainty of discretisation; six times slower."""
    limits: str | None = None
    """File of limits, relative to the campaign; a changed library case has no limits."""
    profile: Annotated[str | None, Field(max_length=500)] = None
    """Profile whose rules are limits at the speed of each run: a name, or a file relative to the campaign."""
    uplift_space_mm: Annotated[float | None, Field(gt=0, le=2000)] = None
    """Space for the uplift at the supports, for a profile [mm]."""
    trust: Trust = "secondary"
    """Lowest trust of the limits that count."""
    execution: Execution = Execution()


# Variations on the command line: `--vary KEY=200:350:10` and `--vary KEY=85,200`.
VARY_OPTION = "option --vary"
"""Option of the command line that varies an input."""

HINT = "Write KEY=START:STOP:STEP or KEY=VALUE,VALUE, e.g. speed_km_h=200:350:10 ."

_NUMBER = r"\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*"
_RANGE = re.compile(f"{_NUMBER}:{_NUMBER}:{_NUMBER}")


def parse_variation(text: str) -> dict[str, Any]:
    """Table [[vary]] of a campaign file from `KEY=START:STOP:STEP` or `KEY=VALUE,VALUE,...` of the command line."""
    key, equals, values = (part.strip() for part in text.partition("="))
    where = f"{VARY_OPTION} {text[:80]!r}"
    if not equals or not key or not values:
        raise InputError(where, "is not a variation", HINT)
    if (match := _RANGE.fullmatch(values)) is not None:
        start, stop, step = (parse_value(number, where) for number in match.groups())
        return {"key": key, "range": {"start": start, "stop": stop, "step": step}}
    try:
        return {"key": key, "values": tomllib.loads(f"values = [{values}]")["values"]}
    except (ValueError, RecursionError):
        return {"key": key, "values": [parse_value(value.strip(), where) for value in values.split(",")]}


def check_variation(variation: dict[str, Any]) -> None:
    """Refuse a variation of the command line whose key does not exist or whose first value is not possible."""
    values = variation["values"] if "values" in variation else [variation["range"]["start"]]
    build_change(variation["key"], next(iter(values), None), VARY_OPTION)
