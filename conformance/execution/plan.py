"""Plans: the options of a run in a file, and their preparation for the run."""

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.catalogue import Catalogue, open_catalogue
from pantocheck.conformance.cases.input_changes import parse_changes, replace_pantographs
from pantocheck.conformance.cases.library import find_entries, overlay_limits, read_limits, select_cases
from pantocheck.conformance.core.decision import DecisionText, parse_decision
from pantocheck.conformance.core.files import check_writable, read_text
from pantocheck.conformance.core.input_error import InputError, suggest_names
from pantocheck.conformance.core.sourced_table import InputTable
from pantocheck.conformance.core.toml_file import MAX_TOML_BYTES, find_key_line, list_table_lines, read_model, read_toml
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.grading.baseline import compare_with_baseline, read_baseline
from pantocheck.conformance.grading.case_selection import CaseSelection, VerdictChoice, choose_verdicts
from pantocheck.conformance.grading.case_verdict import Participation
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.results.administration import Administration
from pantocheck.conformance.results.file_places import CasePlaces, FilePlace, LimitPlace, ReportPlaces
from pantocheck.conformance.results.report_files import Language, check_formats
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.program import split_arguments
from pantocheck.conformance.runs.system import System
from pantocheck.conformance.runs.system_choice import TIMEOUT_S, choose_system
from pantocheck.conformance.studies.damping_sensitivity import add_damping_study

Names = Annotated[tuple[str, ...], Field(strict=False, max_length=1000)]


class Plan(InputTable):
    """Options of `pantocheck run`; an option of the command line replaces that of the plan."""

    cases: Names = ()
    """Ids, globs or paths of cases; default: cases whose limits count, and with verification cases that have
    converged values.
    """
    case_folders: Names = ()
    """Folders with further cases, whose ids begin with own/; they take part without a list of cases."""
    set: Names = ()
    """Changed inputs of the cases, e.g. "speed_km_h=300" or "line.contact_wire.tension_N=22e3"."""
    pantograph: Names = ()
    """Pantograph files in running order, or one for all, in place of those of the cases; an FMU stands for the file
    beside it, fmu.toml or with its own name. The code of an FMU runs only if it is named here.
    """
    system: str = "builtin"
    """Builtin, record:DIR or command:PROGRAM ARGUMENTS."""
    information: Names = ()
    """Ids or globs of cases that are shown, but do not take part in the verdict."""
    accept_unconfirmed: Names = ()
    """Names of systems whose unconfirmed records may pass."""
    timeout_s: Annotated[float, Field(gt=0)] = TIMEOUT_S
    """Time limit of a program for a case [s]."""
    out: str = "report"
    """Folder of the results."""
    language: Language = "en"
    """Language of the certificate and of the summary: en, de, fr, it or es."""
    formats: Names | None = None
    """Formats of the report: html, pdf, json, csv, junit, md, badge, annotations, codequality, figures; default: the
    first six, pdf only if the extra `pdf` is installed.
    """
    trust: Trust = "secondary"
    """Lowest trust of the limits that count."""
    decision: DecisionText = "simple"
    """Decision rule: simple, guarded, or shared-risk: and the largest accepted risk, e.g. shared-risk:0.05."""
    verdicts: VerdictChoice | None = None
    """Verdicts that decide; default: criteria for the builtin system, both for any other."""
    limits: str | None = None
    """File of limits that replace or extend those of the cases."""
    baseline: str | None = None
    """Earlier results.json; a value that drifts from it fails."""
    drift_pct: Annotated[float, Field(gt=0, le=100)] = 1.0
    """Largest drift of a value from its baseline [%]."""
    jobs: Annotated[int, Field(ge=1, le=256)] | None = None
    """Number of processors, for cases and for the meshes of a case; default: one case at a time, whose meshes and
    starts use all processors, at most four.
    """
    damping_study: bool = False
    """Run every case also with the benchmark, initial and updated damping models."""
    administration: Administration | None = None
    """Issuer, number and other administrative data of the report."""


@dataclass(frozen=True)
class PreparedPlan:
    """Plan whose files are read and checked, ready to run."""

    plan: Plan
    """Options of the run."""
    cases: tuple[Case, ...]
    """Selected cases with the limits and studies of the plan."""
    formats: tuple[str, ...]
    """Formats of the report in the order they are written."""
    out: Path
    """Folder of the results."""
    baseline: Results | None
    """Earlier results that values are compared with."""
    participation: Participation
    """Cases shown for information, and accepted unconfirmed records."""
    added: dict[str, tuple[str, ...]]
    """Cases that are not named themselves, each with the cases that require it."""

    def start_system(self) -> System:
        """System under test; a program is started once to learn its name. The folder of the results can be written."""
        system = choose_system(self.plan.system, self.plan.timeout_s)
        check_writable(self.out)
        return system

    def compare(self, results: Results) -> Results:
        """Results with a failed criterion for every value that drifts from the baseline."""
        if self.baseline is None or self.plan.baseline is None:
            return results
        return compare_with_baseline(results, self.baseline, self.plan.drift_pct, Path(self.plan.baseline).name)


def prepare_plan(plan: Plan) -> PreparedPlan:
    """Select and read the cases of a plan, and check its options."""
    for option, given in (("--set", plan.set), ("--pantograph", plan.pantograph)):
        if given and not plan.cases:
            raise InputError(f"option {option}", "no case is named", "Name the cases whose inputs you want to change.")
    catalogue = open_catalogue(plan.case_folders)
    changes = (*replace_pantographs(plan.pantograph), *parse_changes(plan.set))
    cases = select_cases(plan.cases or ["*"], changes, catalogue)
    if plan.limits is not None:
        cases = overlay_limits(cases, read_limits(Path(plan.limits)))
    requested = choose_verdicts(plan.verdicts, plan.system)
    selection = CaseSelection(plan.trust, requested)
    if not plan.cases:
        cases = selection.select_counted(cases)
        if not cases:
            raise InputError("cases", f"no limit counts at trust '{plan.trust}'", "Name a case, or lower the trust.")
    own = _keep_named(cases, plan.cases, catalogue) if plan.cases else list(filter(selection.counts, cases))
    if plan.damping_study:
        cases = [add_damping_study(case) for case in cases]
    formats = check_formats(plan.formats)
    baseline = None if plan.baseline is None else read_baseline(Path(plan.baseline))
    participation = Participation(
        information=_list_information(cases, plan, selection),
        accepted_unconfirmed=plan.accept_unconfirmed,
        requested=requested,
        verification_only=() if plan.cases else selection.list_verification_only(cases),
        decision=parse_decision(plan.decision),
    )
    return PreparedPlan(plan, tuple(cases), formats, Path(plan.out), baseline, participation, _list_added(cases, own))


def _keep_named(cases: Sequence[Case], names: Sequence[str], catalogue: Catalogue) -> list[Case]:
    """Cases without those that no name selects, and that only other cases require."""
    required = {name for case in cases for name in case.file.requires}
    entries = find_entries(names, catalogue)
    return [case for case in cases if case.id not in required or catalogue.find_id(case.id) in entries]


def _list_added(cases: Sequence[Case], own: Sequence[Case]) -> dict[str, tuple[str, ...]]:
    """Cases of a run that are not its own, each with the cases that require it."""
    added = {case.id for case in cases} - {case.id for case in own}
    return {
        case.id: tuple(other.id for other in cases if case.id in other.file.requires)
        for case in cases
        if case.id in added
    }


def _list_information(cases: Sequence[Case], plan: Plan, selection: CaseSelection) -> tuple[str, ...]:
    """Ids of the cases for information: those of the plan, and required cases of a default run that do not count."""
    for i, pattern in enumerate(plan.information, 1):
        if not any(fnmatchcase(case.id, pattern) for case in cases):
            names = suggest_names(pattern, [case.id for case in cases])
            raise InputError(f"plan, key information[{i}]", f"no case of this run matches {pattern!r}", names)
    listed = [case.id for case in cases if any(fnmatchcase(case.id, pattern) for pattern in plan.information)]
    required = [case.id for case in cases if not plan.cases and not selection.counts(case)]
    return tuple(dict.fromkeys([*listed, *required]))


def read_plan(path: Path) -> Plan:
    """Read a plan; paths in it are relative to its file."""
    plan, folder = read_model(path, Plan, "plan"), path.parent
    if "system" not in plan.model_fields_set:
        raise InputError(
            f"plan '{path.name}', key system",
            "missing",
            "Name the system under test: builtin, record:DIR or command:PROGRAM.",
        )
    return plan.model_copy(
        update={
            "cases": resolve_cases(plan.cases, folder),
            "case_folders": tuple(str(folder / name) for name in plan.case_folders),
            "pantograph": tuple(str(folder / name) for name in plan.pantograph),
            "system": resolve_system(plan.system, folder),
            "out": str(folder / plan.out),
            "baseline": None if plan.baseline is None else str(folder / plan.baseline),
            "limits": None if plan.limits is None else str(folder / plan.limits),
        }
    )


def split_names(text: str) -> tuple[str, ...]:
    """Names that are separated by commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def resolve_cases(names: Sequence[str], folder: Path) -> tuple[str, ...]:
    """Ids, globs and paths of cases; paths are relative to the folder of their file."""
    return tuple(str(folder / name) if name.endswith(".toml") else name for name in names)


def resolve_system(system: str, folder: Path) -> str:
    """Text of a system whose folder or program is relative to the folder of its file."""
    kind, _, rest = system.partition(":")
    if kind == "record":
        return f"record:{_find_record_folder(folder, rest)}"
    return f"command:{shlex.join(split_arguments(rest, folder))}" if kind == "command" else system


def _find_record_folder(folder: Path, name: str) -> Path:
    """Folder of records beside the plan, or that of the library if there is none."""
    beside = folder / name
    return Path(name) if not beside.is_dir() and (library_folder() / name).is_dir() else beside


# Places of cases and limits in the files of the user, for annotations of a change.
def locate_plan(plan: Plan, file: Path | None) -> ReportPlaces:
    """Places of the cases and limits of a plan that is read and checked; without a file, of the command line.

    A limit lies in the limits file or in the case file; an installed case, and a drift, in the plan.
    """
    default = None if file is None else _locate_key(file, "cases")
    baseline = None if file is None or plan.baseline is None else _locate_key(file, "baseline")
    own_limits = [] if plan.limits is None else [*_list_limits(Path(plan.limits), "limit")]
    cases = {}
    for entry in find_entries(plan.cases, open_catalogue(plan.case_folders)):
        path, name = entry.path, _name_case(entry.path)
        added = [limit for pattern, limit in own_limits if fnmatchcase(name, pattern)]
        if entry.origin is None or entry.origin.kind == "distribution":
            cases[name] = CasePlaces(default, _sort_limits(added))
        else:
            stated = [limit for _, limit in _list_limits(path, "limit")]
            cases[name] = CasePlaces(_locate_key(path, "id"), (*_sort_limits(added), *_sort_limits(stated)))
    return ReportPlaces(default, baseline, cases)


def locate_record(record: Path, profile: str, limits: Path | None) -> ReportPlaces:
    """Places of an assessment: limits in the limits file or in the user's profile; anything else in the record."""
    own = [] if limits is None else [limit for _, limit in _list_limits(limits, "limit")]
    rules = [limit for _, limit in _list_limits(Path(profile), "rule")] if profile.endswith(".toml") else []
    return ReportPlaces(FilePlace(record), limits=(*_sort_limits(own), *_sort_limits(rules)))


def _name_case(path: Path) -> str:
    """Id of a case."""
    if path.is_relative_to(folder := library_folder()):
        return path.relative_to(folder).with_suffix("").as_posix()
    return str(read_toml(path, "case").get("id", ""))


def _list_limits(path: Path, name: str) -> Iterator[tuple[str, LimitPlace]]:
    """Limits of a file with the pattern of their cases."""
    tables: list[dict[str, Any]] = read_toml(path, "file").get(name, [])
    text = read_text(path, f"file '{path.name}'", MAX_TOML_BYTES)
    lines: tuple[int | None, ...] = list_table_lines(text, name)
    if len(lines) != len(tables):  # tables inside other values
        lines = (find_key_line(text, name),) * len(tables)
    for table, line in zip(tables, lines, strict=True):
        target = (table["quantity"], table.get("pantograph"), table.get("item"))
        yield table.get("case", "*"), LimitPlace(*target, FilePlace(path, line))


def _sort_limits(limits: list[LimitPlace]) -> tuple[LimitPlace, ...]:
    """Limits in the order of precedence: those that name a pantograph, and the last of a file, first."""
    return tuple(sorted(limits, key=lambda limit: limit.pantograph is not None)[::-1])


def _locate_key(path: Path, key: str) -> FilePlace:
    return FilePlace(path, find_key_line(read_text(path, f"file '{path.name}'", MAX_TOML_BYTES), key))
