"""Library of reference cases, and reading of case files by id, pattern or path, with the agreement of their files."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

from pydantic import BaseModel

from pantocheck.conformance.cases.case import Case, CaseOrigin
from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.case_parts import CaseFiles
from pantocheck.conformance.cases.case_source import list_library
from pantocheck.conformance.cases.catalogue import LIBRARY, CaseEntry, Catalogue
from pantocheck.conformance.cases.input_changes import InputChange
from pantocheck.conformance.cases.lift_force import resolve_lift_force
from pantocheck.conformance.cases.limits import Limit, LimitOverride, LimitsFile, own_limits, repeat_limits
from pantocheck.conformance.core.input_error import InputError, join_errors, suggest_names
from pantocheck.conformance.core.toml_file import read_model, read_toml
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.force_law import LawInvalid
from pantocheck.conformance.pantograph.pantograph_file import PantographFile


def find_disagreements(case: Case, where: str) -> Iterator[InputError]:
    """Disagreements between a case and its line.

    Args:
        case: Case whose files are valid, each by itself.
        where: Name of the case file in messages.
    """
    where = f"{where}, key "
    yield from _find_invalid_laws(case, where)
    if not case.is_static:
        outside = [*_find_spans_outside(case, where)]
        yield from outside or _find_positions_outside(case, where)
    yield from _find_wrong_drops(case, f"{where}mass_drop.")


def _find_invalid_laws(case: Case, where: str) -> Iterator[InputError]:
    speed = case.file.speed_km_h or 0.0
    for i, (use, pantograph) in enumerate(zip(case.file.pantograph, case.pantographs, strict=True), 1):
        try:
            resolve_lift_force(use, pantograph, speed)
        except LawInvalid as error:
            hint = "Give uplift_force_N or target_mean_force_N in place of force_from, or another force law or speed."
            yield InputError(f"{where}pantograph[{i}].force_from", str(error), hint)


def _find_spans_outside(case: Case, where: str) -> Iterator[InputError]:
    geometry = case.line.geometry
    for key in ("evaluated_spans", "compared_spans"):
        last = (getattr(case.file, key) or (1,))[-1]
        if last > geometry.spans:
            yield InputError(f"{where}{key}", f"span {last} does not exist", f"The line has {geometry.spans} spans.")
    if case.file.evaluated_m is not None and case.file.evaluated_m[1] > geometry.length:
        yield InputError(
            f"{where}evaluated_m",
            f"the analysis section ends at {case.file.evaluated_m[1]:g} m",
            f"The line ends at {geometry.length:g} m.",
        )


def _find_positions_outside(case: Case, where: str) -> Iterator[InputError]:
    if case.start >= case.recorded_section[0]:
        yield InputError(
            f"{where}start_m",
            f"the last pantograph starts at {case.start:g} m, but the analysis section begins at "
            f"{case.recorded_section[0]:g} m",
            "Reduce start_m, or evaluate a later section.",
        )
    front, length = case.end_positions[0], case.line.geometry.length
    if front >= length:
        yield InputError(
            f"{where}run_out_m",
            f"the first pantograph would run to {front:g} m, but the line is {length:g} m long{_default_run_out(case)}",
            _shorter_section(case),
        )


def _default_run_out(case: Case) -> str:
    if case.file.run_out_m is not None:
        return ""
    return f". The file has no run_out_m; its default here is {case.end - case.recorded_section[1]:g} m"


def _shorter_section(case: Case) -> str:
    geometry = case.line.geometry
    room = geometry.length - case.offsets[-1] - (case.file.run_out_m or 0.0)
    last = sum(limit < room for limit in geometry.span_limits[1:])
    keys = "evaluated_m" if case.file.evaluated_m is not None else "evaluated_spans and compared_spans"
    shorter = f"End {keys} with span {last} at the latest" if last else "Reduce spacing_m"
    return f"{'Reduce run_out_m. ' if case.file.run_out_m else ''}{shorter}, or add spans to the line."


def _find_wrong_drops(case: Case, where: str) -> Iterator[InputError]:
    drops = case.file.mass_drop
    if drops is None:
        return
    length = case.line.geometry.length
    positions = {"drop": [drop.x_m for drop in drops.drop], "sensor": [sensor.x_m for sensor in drops.sensor]}
    for name, along in positions.items():
        for i, x in enumerate(along, 1):
            if not 0 < x < length:
                yield InputError(
                    f"{where}{name}[{i}].x_m",
                    f"{x:g} m is not on the line",
                    f"Give a position between 0 and {length:g} m, the ends of the line.",
                )
    step, every = case.file.discretisation.time_step_s, 1 / drops.rate_Hz
    if abs(every / step - round(every / step)) > 1e-6:
        yield InputError(
            f"{where}rate_Hz",
            f"the sampling interval of {every:g} s is not a multiple of the time step of {step:g} s",
            f"Give {1 / step:g} Hz divided by a whole number, e.g. {1 / step / max(1, round(every / step)):g} .",
        )


# Selection and reading of cases.
def select_cases(
    patterns: Sequence[str], changes: Sequence[InputChange] = (), catalogue: Catalogue = LIBRARY
) -> list[Case]:
    """Read cases by id, pattern or path, in this order, each after the cases that it requires.

    Args:
        patterns: Ids, patterns with `*` and `?`, and paths of case files.
        changes: Changes of the selected cases; those of the line apply to the required cases, too.
        catalogue: Cases that have an id.

    Returns:
        Selected cases, without repetition.

    Raises:
        InputError: A pattern matches no case, or a file is invalid.
    """
    named = {entry: load_entry(entry, changes) for entry in find_entries(patterns, catalogue)}
    of_line = [change for change in changes if change.part == "line"]

    def find_required(name: str) -> Case | None:
        entry = catalogue.find_id(name)
        if entry is None:
            return None
        return named[entry] if entry in named else load_entry(entry, of_line)

    chosen: dict[str, Case] = {}
    for case in named.values():
        _add(case, catalogue, chosen, find_required, ())
    return list(chosen.values())


def load_entry(entry: CaseEntry, changes: Sequence[InputChange] = ()) -> Case:
    """Read the case of an entry of a catalogue; parameters and errors as in `load_case`."""
    return load_case(entry.path, changes, entry.origin)


def find_entries(patterns: Sequence[str], catalogue: Catalogue = LIBRARY) -> list[CaseEntry]:
    """Find cases by id, pattern or path, in this order and each once; parameters and errors as in `select_cases`."""
    return list(dict.fromkeys(entry for pattern in patterns for entry in catalogue.find(pattern)))


def _add(
    case: Case,
    catalogue: Catalogue,
    chosen: dict[str, Case],
    find_required: Callable[[str], Case | None],
    above: tuple[str, ...],
) -> None:
    """Add a case after all cases that it requires; `above` holds the ids of the cases that require it."""
    where = f"case '{case.id}', key requires"
    if case.id in above:
        circle = " > ".join((*above, case.id))
        raise InputError(where, f"the case requires itself ({circle})", "Remove one of these requirements.")
    for name in case.file.requires:
        if (required := find_required(name)) is None:
            raise InputError(where, f"there is no case {name!r}", suggest_names(name, list(catalogue.listed)))
        _add(required, catalogue, chosen, find_required, (*above, case.id))
    if chosen.setdefault(case.id, case) != case:
        raise InputError(f"case '{case.id}'", "two different files have this id", "Give each case a different id.")


def load_case(path: Path, changes: Sequence[InputChange] = (), origin: CaseOrigin | None = None) -> Case:
    """Read a case file with its line and pantographs, and check that they agree.

    Args:
        path: Case file.
        changes: Changes of the case, its line and its pantographs. A changed case with the id of a library case has no
            limits.
        origin: Source of a case from outside the library.

    Raises:
        InputError: A file cannot be read or is invalid, or the files do not agree. The error lists all problems.
    """
    tree = read_toml(path, "case")
    if (kind := recognise_named_file(tree.keys())) is not None:
        raise InputError(
            f"file '{path.name}'",
            f"is a {kind}, not a case",
            f"Give a case that names it, e.g. `pantocheck new case my-case.toml --{kind} {path.name}`. "
            "`pantocheck check` checks it alone; `pantocheck line draw LINE.toml --out FILE` draws a line.",
        )
    files = CaseFiles(path, tree, tuple(changes))
    try:
        case = replace(files.read(), origin=origin)
    except InputError as error:
        raise join_errors([error, *files.list_errors()]) from None
    if disagreements := [*find_disagreements(case, f"case '{path.name}'")]:
        raise join_errors(disagreements)
    # The limits of a library case were published for its inputs, not for changed ones.
    library = list_library(library_folder())
    if case.changes and case.id in library:
        return case.without_limits()
    if path.resolve() in {other.resolve() for other in library.values()}:
        return case
    return replace(case, limits=own_limits(case.limits, list_library_limits(case.id)))


@cache
def find_library_case(case_id: str) -> Case | None:
    """Case of the library with this id, read once; None if there is none."""
    path = list_library(library_folder()).get(case_id)
    return None if path is None else load_case(path)


def list_library_limits(case_id: str) -> tuple[Limit, ...]:
    """Limits of the library case with this id; none if there is no such case."""
    case = find_library_case(case_id)
    return () if case is None else case.limits


def read_limits(path: Path) -> tuple[LimitOverride, ...]:
    """Read a limits file: its limits are own, whatever they claim."""
    return own_limits(read_model(path, LimitsFile, "limits").limit)


def overlay_limits(cases: Sequence[Case], limits: Sequence[LimitOverride]) -> list[Case]:
    """Add the limits of a user to cases; a limit replaces that of the case with the same target.

    Args:
        cases: Cases of the run.
        limits: Limits of the user.

    Returns:
        Cases with these limits.

    Raises:
        InputError: A limit matches none of the cases, or none of the matching cases has its pantograph.
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
    return [case.with_limits(repeat_limits(added[case.id], len(case.pantographs))) for case in cases]


@cache
def read_bibliography() -> dict[str, str]:
    """Bibliographic references of the library, by source key."""
    return {str(key): str(text) for key, text in read_toml(library_folder() / "sources.toml", "bibliography").items()}


def source_text(source: str | Sequence[str]) -> str:
    """Text of sources: the bibliographic reference for a source key, free text unchanged."""
    keys = (source,) if isinstance(source, str) else source
    return "; ".join(read_bibliography().get(key, key) for key in keys)


# Recognition of a line or a pantograph in the place of a case.
FORMATS: dict[str, type[BaseModel]] = {"line": LineFile, "pantograph": PantographFile}
"""Files that a case names."""


def recognise_named_file(keys: Collection[str]) -> str | None:
    """Kind of a file that a case names, a key of `FORMATS`; None for a case and for unknown keys.

    Args:
        keys: Keys of the file. A case is recognised by `id` or `line`.
    """
    if {"id", "line"} & {*keys}:
        return None
    shares = {
        kind: len(({*model.model_fields} - {*CaseFile.model_fields}) & {*keys}) for kind, model in FORMATS.items()
    }
    best = max(shares, key=lambda kind: shares[kind])
    return best if shares[best] else None


def leave_out_required(pattern: str, cases: list[Case]) -> list[Case]:
    """Cases that the pattern selects itself, without the cases that they require."""
    exact = [case for case in cases if case.id == pattern]
    required = {name for case in cases for name in case.file.requires}
    return exact or [case for case in cases if case.id not in required] or cases
