"""Library of reference cases, and reading of case files by id, pattern or path."""

import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping_file import Damping, DampingFile, overlay_damping
from pantocheck.conformance.cases.library_folder import library_folder
from pantocheck.conformance.cases.limits import Limit, LimitOverride, LimitsFile
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.toml_file import read_model, read_toml

_ID = re.compile(r"^id\s*=", re.MULTILINE)


@cache
def list_library(folder: Path) -> dict[str, Path]:
    """Files of all cases below a folder, by id; the id of a case is its path in the folder."""
    # Lines, pantographs and the bibliography are in the same folders; only a case file has an id.
    return {
        path.relative_to(folder).with_suffix("").as_posix(): path
        for path in sorted(folder.rglob("*.toml"))
        if _ID.search(path.read_text(encoding="utf-8"))
    }


def select_cases(patterns: Sequence[str]) -> list[Case]:
    """Read cases by id, pattern or path, in this order, each after the cases that it requires.

    Parameters
    ----------
    patterns : sequence of str
        Ids, patterns with `*` and `?`, and paths of case files.

    Returns
    -------
    list of Case
        Selected cases, without repetition.

    Raises
    ------
    InputError
        A pattern matches no case, or a file is invalid.
    """
    known = list_library(library_folder())
    chosen: dict[str, Case] = {}
    for pattern in patterns:
        for path in _match_pattern(pattern, known):
            _add(load_case(path), known, chosen, ())
    return list(chosen.values())


def _match_pattern(pattern: str, known: dict[str, Path]) -> list[Path]:
    if pattern in known:
        return [known[pattern]]
    if pattern.endswith(".toml"):
        return [Path(pattern)]
    matches = [path for name, path in known.items() if fnmatchcase(name, pattern)]
    if not matches:
        raise InputError(
            f"case '{pattern}'",
            "there is no case with this id",
            suggest_names(pattern, list(known)) + " `pantocheck cases` lists all cases.",
        )
    return matches


def _add(case: Case, known: dict[str, Path], chosen: dict[str, Case], above: tuple[str, ...]) -> None:
    """Add a case after all cases that it requires; `above` holds the ids of the cases that require it."""
    where = f"case '{case.id}', key requires"
    if case.id in above:
        circle = " > ".join((*above, case.id))
        raise InputError(where, f"the case requires itself ({circle})", "Remove one of these requirements.")
    for required in case.file.requires:
        if required not in known:
            raise InputError(where, f"there is no case {required!r}", suggest_names(required, list(known)))
        _add(load_case(known[required]), known, chosen, (*above, case.id))
    if chosen.setdefault(case.id, case) != case:
        raise InputError(f"case '{case.id}'", "two different files have this id", "Give each case a different id.")


def load_case(path: Path) -> Case:
    """Read a case file with its line and pantographs, and check that they agree.

    Parameters
    ----------
    path : Path
        Case file.

    Returns
    -------
    Case
        The case.

    Raises
    ------
    InputError
        A file cannot be read, or is invalid.
    """
    file = read_model(path, CaseFile, "case")
    line = read_model(_locate(path, file.line, "line"), LineFile, "reference line")
    if file.damping is not None:
        damping = _read_damping(path, file.damping, "damping") if isinstance(file.damping, str) else file.damping
        line = line.model_copy(update={"damping": overlay_damping(line.damping, damping)})
    pantographs = tuple(
        _read_pantograph(path, use.model, f"pantograph[{i}].model") for i, use in enumerate(file.pantograph, 1)
    )
    static_pantograph = None
    if file.apparent_mass is not None:
        static_pantograph = _read_pantograph(path, file.apparent_mass.model, "apparent_mass.model")
    models = dict(file.mass_drop.compared) if file.mass_drop is not None else {}
    models |= getattr(file.study, "models", {}) | getattr(file.study, "before", {})
    dampings = {name: _read_damping(path, model, f"damping model {name!r}") for name, model in models.items()}
    case = Case(file, line, pantographs, file.limit, static_pantograph, dampings)
    _check_geometry(case, f"case '{path.name}', key ")
    _check_drops(case, f"case '{path.name}', key mass_drop.")
    return case


def _read_damping(case_path: Path, name: str, key: str) -> Damping:
    return read_model(_locate(case_path, name, key), DampingFile, "damping").damping


def _read_pantograph(case_path: Path, name: str, key: str) -> PantographFile:
    return read_model(_locate(case_path, name, key), PantographFile, "pantograph")


def _locate(case_path: Path, name: str, key: str) -> Path:
    """Path of a file named in a case: relative to the case file, or else to the library."""
    for folder in (case_path.parent, library_folder()):
        if (folder / name).is_file():
            return folder / name
    raise InputError(
        f"case '{case_path.name}', key {key}",
        f"there is no file {name!r}",
        f"Name a file relative to {case_path.parent} or to the library, e.g. en50318-2002/line.toml .",
    )


def _check_geometry(case: Case, where: str) -> None:
    if case.is_static:
        return
    geometry = case.line.geometry
    for key in ("evaluated_spans", "compared_spans"):
        last = (getattr(case.file, key) or (1,))[-1]
        if last > geometry.spans:
            raise InputError(f"{where}{key}", f"span {last} does not exist", f"The line has {geometry.spans} spans.")
    if case.start >= case.recorded_section[0]:
        raise InputError(
            f"{where}start_m",
            f"the last pantograph starts at {case.start:g} m, but the evaluated spans begin at "
            f"{case.recorded_section[0]:g} m",
            "Reduce start_m, or evaluate later spans.",
        )
    front = case.end_positions[0]
    if front >= geometry.length:
        raise InputError(
            f"{where}run_out_m",
            f"the first pantograph would run to {front:g} m, but the line is {geometry.length:g} m long",
            "Reduce run_out_m, evaluate earlier spans, or add spans to the line.",
        )


def _check_drops(case: Case, where: str) -> None:
    drops = case.file.mass_drop
    if drops is None:
        return
    length = case.line.geometry.length
    positions = {"drop": [drop.x_m for drop in drops.drop], "sensor": [sensor.x_m for sensor in drops.sensor]}
    for name, along in positions.items():
        for i, x in enumerate(along, 1):
            if not 0 < x < length:
                raise InputError(
                    f"{where}{name}[{i}].x_m",
                    f"{x:g} m is not on the line",
                    f"Give a position between 0 and {length:g} m, the ends of the line.",
                )
    step, every = case.file.discretisation.time_step_s, 1 / drops.rate_Hz
    if abs(every / step - round(every / step)) > 1e-6:
        raise InputError(
            f"{where}rate_Hz",
            f"the sampling interval of {every:g} s is not a multiple of the time step of {step:g} s",
            f"Give {1 / step:g} Hz divided by a whole number, e.g. {1 / step / max(1, round(every / step)):g} .",
        )


def read_limits(path: Path) -> tuple[LimitOverride, ...]:
    """Read a limits file."""
    return read_model(path, LimitsFile, "limits").limit


def overlay_limits(cases: Sequence[Case], limits: Sequence[LimitOverride]) -> list[Case]:
    """Add the limits of a user to cases; a limit replaces that of the case with the same target.

    Parameters
    ----------
    cases : sequence of Case
        Cases of the run.
    limits : sequence of LimitOverride
        Limits of the user.

    Returns
    -------
    list of Case
        Cases with these limits.

    Raises
    ------
    InputError
        A limit matches none of the cases, or none of the matching cases has its pantograph.
    """
    added: dict[str, list[Limit]] = {case.id: [] for case in cases}
    for i, limit in enumerate(limits, 1):
        where, matching = f"limits, key limit[{i}]", [case for case in cases if fnmatchcase(case.id, limit.case)]
        if not matching:
            names = suggest_names(limit.case, list(added))
            raise InputError(f"{where}.case", f"no case of this run matches {limit.case!r}", names)
        with_owner = [case for case in matching if limit.owner <= len(case.pantographs)]
        if not with_owner:
            hint = "Pantographs are numbered from 1 in running order."
            raise InputError(f"{where}.pantograph", f"there is no pantograph {limit.owner}", hint)
        for case in with_owner:
            added[case.id].append(limit)
    return [case.with_limits(tuple(added[case.id])) for case in cases]


@cache
def read_bibliography() -> dict[str, str]:
    """Bibliographic references of the library, by source key."""
    return {str(key): str(text) for key, text in read_toml(library_folder() / "sources.toml", "bibliography").items()}


def source_text(source: str | Sequence[str]) -> str:
    """Text of sources: the bibliographic reference for a source key, free text unchanged."""
    keys = (source,) if isinstance(source, str) else source
    return "; ".join(read_bibliography().get(key, key) for key in keys)
