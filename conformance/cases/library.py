"""The library of reference cases, and a user's own case files: finding them by id, glob or path."""

import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from functools import cache
from importlib.resources import files
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping_file import Damping, DampingFile
from pantocheck.conformance.cases.damping_file import overlay_damping as overlaid_damping
from pantocheck.conformance.cases.limits import LimitOverride, LimitsFile
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.toml_file import read_model, read_toml

_ID = re.compile(r"^id\s*=", re.MULTILINE)


def library_folder() -> Path:
    """Folder of the reference cases that come with the suite."""
    return Path(str(files("pantocheck.reference_cases")))


@cache
def list_library(folder: Path) -> dict[str, Path]:
    """Ids of all cases below a folder, from the folder structure, each with its file."""
    found = {}
    for path in sorted(folder.rglob("*.toml")):
        # Lines, pantographs and the bibliography lie beside the cases, but only a case has an id.
        if _ID.search(path.read_text(encoding="utf-8")):
            found[path.relative_to(folder).with_suffix("").as_posix()] = path
    return found


def select_cases(patterns: Sequence[str]) -> list[Case]:
    """Cases for ids, globs and paths of case files, in the order asked, those they require put before them.

    Without a pattern: every case of the library that has limits and is not marked to be run on request only.

    Raises
    ------
    InputError
        a pattern matches nothing (the nearest ids are named), or a file is wrong.
    """
    known = list_library(library_folder())
    chosen: dict[str, Case] = {}
    for pattern in patterns or ["*"]:
        for path in _matching(pattern, known):
            _add(load_case(path), known, chosen, ())
    if not patterns:
        graded = {case.id for case in chosen.values() if case.limits and not case.file.on_request}
        needed = {required for case in chosen.values() if case.id in graded for required in case.file.requires}
        return [case for case in chosen.values() if case.id in graded | needed]
    return list(chosen.values())


def _matching(pattern: str, known: dict[str, Path]) -> list[Path]:
    if pattern in known:
        return [known[pattern]]
    if pattern.endswith(".toml"):
        return [Path(pattern)]
    matches = [path for name, path in known.items() if fnmatchcase(name, pattern)]
    if not matches:
        raise InputError(
            f"case '{pattern}'",
            "there is no such case",
            suggest_names(pattern, list(known)) + " `pantocheck cases` lists all.",
        )
    return matches


def _add(case: Case, known: dict[str, Path], chosen: dict[str, Case], above: tuple[str, ...]) -> None:
    if case.id in above:
        raise InputError(
            f"case '{case.id}', key requires",
            f"requires itself ({' > '.join((*above, case.id))})",
            "Take one of these out.",
        )
    for required in case.file.requires:
        if required not in known:
            raise InputError(
                f"case '{case.id}', key requires",
                f"there is no case {required!r}",
                suggest_names(required, list(known)),
            )
        _add(load_case(known[required]), known, chosen, (*above, case.id))
    if chosen.setdefault(case.id, case) != case:
        raise InputError(f"case '{case.id}'", "two different files have this id", "Give each case an id of its own.")


def load_case(path: Path) -> Case:
    """Read a case file with its line and pantographs, and check that they fit together.

    Raises
    ------
    InputError
        a file cannot be read, or is wrong.
    """
    file = read_model(path, CaseFile, "case")
    line = read_model(_beside(path, file.line, "line"), LineFile, "reference line")
    if file.damping is not None:
        over = _damping(path, file.damping, "damping") if isinstance(file.damping, str) else file.damping
        line = line.model_copy(update={"damping": overlaid_damping(line.damping, over)})
    pantographs = tuple(
        read_model(_beside(path, use.model, f"pantograph[{i}].model"), PantographFile, "pantograph")
        for i, use in enumerate(file.pantograph, 1)
    )
    measured = None
    if file.apparent_mass is not None:
        beside = _beside(path, file.apparent_mass.model, "apparent_mass.model")
        measured = read_model(beside, PantographFile, "pantograph")
    case = Case(file, line, pantographs, file.limit, measured, _dampings(path, file))
    _check_geometry(case, path)
    _check_drops(case, path)
    return case


def _damping(case_path: Path, name: str, key: str) -> Damping:
    return read_model(_beside(case_path, name, key), DampingFile, "damping").damping


def _dampings(path: Path, file: CaseFile) -> dict[str, Damping]:
    """The other damping models that a case names, read."""
    named = dict(file.mass_drop.compared) if file.mass_drop is not None else {}
    if file.study is not None:
        named |= getattr(file.study, "models", {}) | getattr(file.study, "before", {})
    return {name: _damping(path, found, f"damping model {name!r}") for name, found in named.items()}


def _beside(case_path: Path, name: str, key: str) -> Path:
    """A file named by a case: relative to the case, or else to the library."""
    for folder in (case_path.parent, library_folder()):
        if (folder / name).is_file():
            return folder / name
    raise InputError(
        f"case '{case_path.name}', key {key}",
        f"there is no file {name!r}",
        f"Name a file relative to {case_path.parent}, or one of the library, e.g. en50318-2002/line.toml .",
    )


def _check_geometry(case: Case, path: Path) -> None:
    if case.is_static:
        return
    geometry, where = case.line.geometry, f"case '{path.name}'"
    for key in ("evaluated_spans", "compared_spans"):
        last = (getattr(case.file, key) or (1,))[-1]
        if last > geometry.spans:
            raise InputError(
                f"{where}, key {key}", f"span {last} does not exist", f"The line has {geometry.spans} spans."
            )
    if case.start >= case.recorded_section[0]:
        raise InputError(
            f"{where}, key start_m",
            f"the last pantograph starts at {case.start:g} m, not before the evaluated "
            f"spans, which begin at {case.recorded_section[0]:g} m",
            "Start earlier, or evaluate later spans.",
        )
    front = case.end_positions[0]
    if front >= geometry.length:
        raise InputError(
            f"{where}, key run_out_m",
            f"the first pantograph would run to {front:g} m on a line of {geometry.length:g} m",
            "Add spans, evaluate earlier ones, or shorten run_out_m.",
        )


def _check_drops(case: Case, path: Path) -> None:
    drops = case.file.mass_drop
    if drops is None:
        return
    length, where = case.line.geometry.length, f"case '{path.name}'"
    places = {"drop": [test.x_m for test in drops.drop], "sensor": [sensor.x_m for sensor in drops.sensor]}
    for name, along in places.items():
        for i, x in enumerate(along, 1):
            if not 0 < x < length:
                raise InputError(
                    f"{where}, key mass_drop.{name}[{i}].x_m",
                    f"{x:g} m is not on the line",
                    f"The line goes from 0 to {length:g} m, its ends anchored.",
                )
    step, every = case.file.discretisation.time_step_s, 1 / drops.rate_Hz
    if abs(every / step - round(every / step)) > 1e-6:
        raise InputError(
            f"{where}, key mass_drop.rate_Hz",
            f"a sample every {every:g} s is not a whole number of time steps of {step:g} s",
            f"Give a rate that divides {1 / step:g} Hz, e.g. {1 / step / max(1, round(every / step)):g} .",
        )


def read_limits(path: Path) -> tuple[LimitOverride, ...]:
    """A user's own limits, to be laid over cases."""
    return read_model(path, LimitsFile, "limits").limit


def overlay_limits(cases: Sequence[Case], limits: Sequence[LimitOverride]) -> list[Case]:
    """Cases with a user's limits laid over them.

    Raises
    ------
    InputError
        a limit is for none of the cases, or for a pantograph that its case has not.
    """
    for i, limit in enumerate(limits, 1):
        where, meant = f"limits, key limit[{i}]", [case for case in cases if fnmatchcase(case.id, limit.case)]
        if not meant:
            raise InputError(
                f"{where}.case",
                f"no case that is run matches {limit.case!r}",
                suggest_names(limit.case, [case.id for case in cases]),
            )
        if limit.owner > max(len(case.pantographs) for case in meant):
            raise InputError(
                f"{where}.pantograph", f"there is no pantograph {limit.owner}", "They are numbered from 1 at the front."
            )
    return [
        case.with_limits(
            tuple(
                limit for limit in limits if fnmatchcase(case.id, limit.case) and limit.owner <= len(case.pantographs)
            )
        )
        for case in cases
    ]


@cache
def read_bibliography() -> dict[str, str]:
    """Source keys and the publications they stand for."""
    return {str(key): str(text) for key, text in read_toml(library_folder() / "sources.toml", "bibliography").items()}


def source_text(source: str | Sequence[str]) -> str:
    """Sources as a reader wants them: each key replaced by its publication, free text kept."""
    keys = (source,) if isinstance(source, str) else source
    return "; ".join(read_bibliography().get(key, key) for key in keys)
