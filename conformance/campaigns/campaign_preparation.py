"""Preparation of a campaign: its files are read and checked before the first run."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

from pantocheck.conformance.campaigns.campaign_design import (
    CampaignDesign,
    build_axis,
    list_identifying_rows,
    parse_condition,
    sample_inputs,
)
from pantocheck.conformance.campaigns.campaign_driver import CampaignProgress, Pilots, drive_campaign
from pantocheck.conformance.campaigns.campaign_file import CampaignFile, Execution
from pantocheck.conformance.campaigns.campaign_run import ProfileLimits, RunExecution, build_input_changes, name_column
from pantocheck.conformance.campaigns.campaign_store import CampaignStore
from pantocheck.conformance.campaigns.run_executors import RunExecutor
from pantocheck.conformance.campaigns.uplift_prediction import choose_pilots, fit_uplift
from pantocheck.conformance.cases.case import Case, CaseOrigin, drop_keys, json_digest
from pantocheck.conformance.cases.case_parts import read_named_pantograph
from pantocheck.conformance.cases.case_source import build_repeated_id_error
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes, replace_pantographs
from pantocheck.conformance.cases.library import find_entries, load_entry, overlay_limits, read_limits
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.sourced_table import PROVENANCE
from pantocheck.conformance.core.suite_identity import suite_digest
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.execution.plan import resolve_cases, resolve_system
from pantocheck.conformance.grading.case_identity import limits_digest
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.results.campaign_format import CampaignEnding
from pantocheck.conformance.runs.core_requirement import require_core
from pantocheck.conformance.runs.system_choice import choose_system

OUTSIDE_IDENTITY = {"execution", "title", "cases", "case_folders", "pantograph", "limits", "profile"}
"""Keys of a campaign file on which its results do not depend, or whose content has its own digest."""


@dataclass(frozen=True)
class PreparedCampaign:
    """Campaign whose files are read and checked."""

    file: CampaignFile
    """Content of the campaign file."""
    design: CampaignDesign
    """Runs of the campaign."""
    execute: RunExecution
    """Function that executes one run."""
    identity: dict[str, Any]
    """Parts of the campaign on which its results depend."""
    limits: dict[str, tuple[float | None, float | None]]
    """Lower and upper bound of each limit by the column of its value, such as `1.std_force_N`; limits that differ
    between the cases are left out.
    """
    origins: dict[str, CaseOrigin]
    """Source of each case from outside, by its id."""
    contacts: dict[str, str]
    """Contact of each case with pantographs, and its trust, by its id."""
    pilots: frozenset[int] = frozenset()
    """Numbers of the runs from which the uplift forces of the others are predicted."""

    def drive(
        self, store: CampaignStore, executor: RunExecutor, report: Callable[[CampaignProgress], None] = lambda _: None
    ) -> CampaignEnding:
        """Execute the runs that the store does not hold; parameters as in `drive_campaign`."""
        pilots = (
            Pilots(self.pilots, lambda rows: replace(self.execute, start=fit_uplift(rows))) if self.pilots else None
        )
        return drive_campaign(self.design, self.execute, store, executor, self.file.execution, report, pilots)


def find_campaign_file(name: str) -> Path | None:
    """File of a campaign of the library, such as `campaigns/ac-simple-speed`; None: the name is that of no campaign."""
    path = library_folder() / f"{name}.toml"
    return path if name.startswith("campaigns/") and path.is_file() else None


def read_campaign(path: Path) -> PreparedCampaign:
    """Read and prepare a campaign file; paths in it are relative to the file."""
    return prepare_campaign(read_model(path, CampaignFile, "campaign"), path.parent)


def prepare_campaign(file: CampaignFile, folder: Path) -> PreparedCampaign:
    """Prepare a campaign, whose paths are relative to a folder.

    Raises:
        InputError: A case, table, key, condition, limit or system is wrong.
    """
    named = replace_pantographs([str(folder / name) for name in file.pantograph])
    changes = (*named, *parse_changes(file.set))
    catalogue = open_catalogue([folder / name for name in file.case_folders])
    cases = _read_cases(resolve_cases(file.cases, folder), catalogue)
    limits = () if file.limits is None else read_limits(folder / file.limits)
    profile = None
    if file.profile is not None:
        name = str(folder / file.profile) if file.profile.endswith(".toml") else file.profile
        profile = ProfileLimits(load_profile(name), file.uplift_space_mm)
    design = _build_design(file, folder, tuple(cases))
    files = {case_id: str(path) for case_id, (path, _) in cases.items()}
    timeout, stored = file.execution.timeout_s, file.execution.traces
    execute = RunExecution(files, changes, limits, profile, file.trust, file.refined, timeout, stored)
    _check_systems(design.systems, file.execution)
    first_cases = _check_first_designs(design, execute)
    limited = overlay_limits([case for _, case in cases.values()], limits)
    identity = {
        "campaign": drop_keys(file.model_dump(mode="json", exclude=OUTSIDE_IDENTITY), PROVENANCE),
        "cases": {case.id: [case.digest, limits_digest(case.limits)] for case in limited},
        "designs": json_digest([list_identifying_rows(axis) for axis in design.axes]),
        "pantographs": [
            json_digest(
                read_named_pantograph(Path(str(change.value))).model_dump(mode="json", exclude={"fmu": {"model"}})
            )
            for change in named
        ],
        "profile": None if profile is None else profile.profile.model_dump(mode="json"),
        "suite": suite_digest(),
    }
    origins = {case.id: case.origin for _, case in cases.values() if case.origin is not None}
    contacts = {
        case.id: f"{contact.description} ({contact.trust})"
        for _, case in cases.values()
        for contact in [file.contact for file in case.pantographs[:1]]
    }
    tuned = any(lift.target_mean_force is not None for case in first_cases for lift in case.lift_forces)
    pilots = choose_pilots(design) if tuned and not file.refined else frozenset[int]()
    return PreparedCampaign(file, design, execute, identity, _list_limits(first_cases), origins, contacts, pilots)


def _list_limits(cases: Sequence[Case]) -> dict[str, tuple[float | None, float | None]]:
    """Bounds by the column of the limited value, where all cases that limit it agree."""
    bounds: dict[str, set[tuple[float | None, float | None]]] = {}
    for limit in (limit for case in cases for limit in case.limits):
        column = name_column(str(limit.owner), limit.quantity, limit.item)
        bounds.setdefault(column, set()).add((limit.lower, limit.upper))
    return {column: pairs.pop() for column, pairs in bounds.items() if len(pairs) == 1}


def _read_cases(patterns: Sequence[str], catalogue: Catalogue) -> dict[str, tuple[Path, Case]]:
    """Base cases with their files, by id; a changed input may be valid only beside a varied one."""
    cases: dict[str, tuple[Path, Case]] = {}
    for entry in find_entries(patterns, catalogue):
        case, path = load_entry(entry), entry.path.resolve()
        if cases.setdefault(case.id, (path, case))[0] != path:
            raise build_repeated_id_error(case.id, str(cases[case.id][0]), str(path))
    return cases


def _build_design(file: CampaignFile, folder: Path, case_ids: tuple[str, ...]) -> CampaignDesign:
    """Design of a campaign file, whose keys are checked."""
    samples = () if file.sampling is None else (sample_inputs(file.sampling),)
    axes = (*(build_axis(variation, folder) for variation in file.vary), *samples)
    keys = [key for axis in axes for key in axis.keys]
    for i, link in enumerate(file.link, 1):
        if link.follows not in keys:
            where = f"campaign, key link[{i}].follows"
            raise InputError(where, f"{link.follows!r} is not a varied input", suggest_names(link.follows, keys))
        first = [axis.row(0)[link.follows] for axis in axes if link.follows in axis.keys]
        if any(not isinstance(value, int | float) for value in first):
            found = f"the input {link.follows!r} is not a number"
            raise InputError(f"campaign, key link[{i}].follows", found, f"Vary {link.key} itself, without a link.")
    keys += [link.key for link in file.link]
    repeated = [key for key, count in Counter(keys).items() if count > 1]
    if repeated:
        raise InputError(f"campaign, key {repeated[0]}", "is varied twice", "Vary each input in one place.")
    conditions = tuple(parse_condition(text, keys) for text in file.conditions)
    systems = tuple(resolve_system(system, folder) for system in file.systems)
    return CampaignDesign(case_ids, axes, file.link, conditions, systems)


def _check_systems(systems: Sequence[str], execution: Execution) -> None:
    """Refuse a system that does not exist; a folder per design is looked up by its run."""
    for system in systems:
        if system == "builtin":
            if execution.is_local:  # the workers alone need the core
                require_core("system 'builtin'")
        elif "{design}" not in system:
            choose_system(system, execution.timeout_s)


def _check_first_designs(design: CampaignDesign, execute: RunExecution) -> list[Case]:
    """Cases of the first designs. Refuse a campaign without designs, with an unknown key, or with invalid designs only.

    A key, a unit or a list item is usually wrong in all designs; a single invalid design is a failed run.
    """
    first = list(islice(design.list_runs(), CHECKED_DESIGNS))
    if not first:
        raise InputError("campaign, key conditions", "no design meets them", "Relax a condition.")
    build_input_changes(first[0].inputs)
    cases, problems = [], []
    for run in first:
        try:
            cases.append(execute.read_case(run))
        except InputError as error:
            problems.append(error)
    if not cases:
        raise problems[0]
    return cases


CHECKED_DESIGNS = 5
"""Number of designs whose case is read before the first run."""
