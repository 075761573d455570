"""Places of cases and limits in the files of the user, for annotations of a change."""

from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from pantocheck.conformance.cases.catalogue import open_catalogue
from pantocheck.conformance.cases.library import find_entries
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.input_files.bounded_file import read_text
from pantocheck.conformance.input_files.toml_file import MAX_TOML_BYTES, read_toml
from pantocheck.conformance.input_files.toml_places import find_key_line, list_table_lines
from pantocheck.conformance.plan import Plan
from pantocheck.conformance.results.file_places import CasePlaces, FilePlace, LimitPlace, ReportPlaces


def locate_plan(plan: Plan, file: Path | None) -> ReportPlaces:
    """Places of the cases and limits of a plan that is read and checked.

    Args:
        plan: Options of a run.
        file: File of the plan; None: the options come from the command line.

    Returns:
        A limit lies in the limits file or in the case file; an installed case, and a drift, in the plan.

    Raises:
        InputError: A file cannot be read.
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
    """Places of an assessment: limits in the limits file or in the user's profile; anything else in the record.

    Args:
        record: Assessed record.
        profile: Name of a profile of the library, or path of the user's own.
        limits: Limits file.

    Returns:
        Places for the only case of the results.

    Raises:
        InputError: A file cannot be read.
    """
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
