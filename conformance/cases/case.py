"""Case: the content of a case file with its line, pantographs and damping models."""

import hashlib
import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from pantocheck.conformance.cases.case_file import CaseFile, PantographByLaw, Reading
from pantocheck.conformance.cases.lift_force import AppliedForces, LiftForce, resolve_lift_force
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.core.features import list_features
from pantocheck.conformance.core.sourced_table import PROVENANCE, InputTable, SourcedTable
from pantocheck.conformance.core.texts import DocumentationPage
from pantocheck.conformance.core.trust import Trust
from pantocheck.conformance.line.elements.damping import Damping, overlay_damping
from pantocheck.conformance.line.line_file import LineFile
from pantocheck.conformance.pantograph.fmu_table import FmuTable
from pantocheck.conformance.pantograph.pantograph_file import PantographFile
from pantocheck.conformance.records.sidecar_tables import StartTable

# Origin of a case from outside the library: a file, a folder of the user, or an installed distribution.
OriginKind = Literal["file", "folder", "distribution"]
"""Case file named by its path, folder given with `--cases`, or installed distribution."""


class CaseOrigin(InputTable):
    """File, folder or installed distribution that holds the case file, without its path on this machine."""

    kind: OriginKind
    name: str
    version: str
    """Version of the distribution; empty for a file or folder."""
    digest: str
    """SHA-256 of the case file, or of all TOML files of the folder or distribution."""

    @property
    def text(self) -> str:
        """Origin in messages, such as `distribution acme-lines 1.0`."""
        return f"{self.kind} {self.name} {self.version}".strip()


@dataclass(frozen=True)
class InputProvenance:
    """Source of a group of inputs."""

    group: str
    """Dotted name of a table, or of one of its keys."""
    trust: Trust
    """Stated trust."""
    source: tuple[str, ...]
    """Source keys."""


@dataclass(frozen=True)
class Case:
    """Reference case: line, pantographs, analysis section and limits."""

    file: CaseFile
    """Content of the case file."""
    line: LineFile
    """Line of the case."""
    pantographs: tuple[PantographFile, ...]
    """One pantograph per [[pantograph]] table, in running order."""
    limits: tuple[Limit, ...]
    """Limits of the file, merged with those of a user."""
    static_pantograph: PantographFile | None = None
    """Pantograph whose apparent mass a static case computes."""
    dampings: Mapping[str, Damping] = field(default_factory=dict)
    """Further damping models of a study or a comparison, by name."""
    changes: tuple[str, ...] = ()
    """Inputs that were changed on the command line, with the values of the files."""
    origin: CaseOrigin | None = field(default=None, compare=False)
    """Source of a case from outside; None: the library."""

    @property
    def pantograph_files(self) -> tuple[PantographFile, ...]:
        """All pantographs of the case: those of the run, and that of a static case."""
        return self.pantographs if self.static_pantograph is None else (*self.pantographs, self.static_pantograph)

    @property
    def fmus(self) -> tuple[FmuTable, ...]:
        """FMUs that move pantographs of the run."""
        return tuple(pantograph.fmu for pantograph in self.pantographs if pantograph.fmu is not None)

    @property
    def id(self) -> str:
        """Id of the case, a path-like name."""
        return self.file.id

    @property
    def is_static(self) -> bool:
        """Whether the case is a check of the line at rest, without a train."""
        return self.file.speed_km_h is None

    @property
    def speed(self) -> float:
        """Speed of the train [m/s]; 0 for a static case."""
        return (self.file.speed_km_h or 0.0) / 3.6

    @property
    def analysis_section(self) -> tuple[float, float]:
        """Start and end of the analysis section [m]; the line begins at 0."""
        return self.file.evaluated_m or self.line.geometry.section(*self.analysed_spans)

    @property
    def analysed_spans(self) -> tuple[int, int]:
        """First and last span that the analysis section touches; without a section, those of the line."""
        if self.file.evaluated_m is not None:
            return self.line.geometry.spans_of_section(*self.file.evaluated_m)
        spans = self.file.evaluated_spans or (1, self.line.geometry.spans)
        return spans[0], spans[-1]

    @property
    def shifted_sections(self) -> tuple[tuple[float, float], ...]:
        """Positions of the analysis section when it is shifted span by span along the compared spans [m, m]."""
        if self.file.compared_spans is None or self.file.evaluated_spans is None:
            return ()
        (first, last), spans = self.file.compared_spans, self.file.evaluated_spans
        length = spans[-1] - spans[0]
        return tuple(self.line.geometry.section(i, i + length) for i in range(first, last + 1 - length))

    @property
    def recorded_section(self) -> tuple[float, float]:
        """Start and end of the section that a record must cover: compared spans, or else the analysis section [m]."""
        if self.file.compared_spans is None:
            return self.analysis_section
        return self.line.geometry.section(*self.file.compared_spans)

    @property
    def lift_forces(self) -> tuple[LiftForce, ...]:
        """Lift force of every pantograph of the run: stated in the case, or from the force law of its file."""
        speed = self.file.speed_km_h or 0.0
        uses = zip(self.file.pantograph, self.pantographs, strict=True)
        return tuple(resolve_lift_force(use, pantograph, speed) for use, pantograph in uses)

    @property
    def law_forces(self) -> dict[int, LiftForce]:
        """Lift force of every pantograph whose force law applies, by its number from 1."""
        parts = enumerate(zip(self.file.pantograph, self.lift_forces, strict=True), 1)
        return {number: lift for number, (use, lift) in parts if isinstance(use, PantographByLaw)}

    @property
    def offsets(self) -> tuple[float, ...]:
        """Distance of each pantograph behind the first [m]."""
        spacing = self.file.spacing_m or ()
        return tuple(sum(spacing[:i]) for i in range(len(self.pantographs)))

    @property
    def start(self) -> float:
        """Position of the last pantograph at the start of the run [m]."""
        return self.line.geometry.span(1)[1] if self.file.start_m is None else self.file.start_m

    @property
    def end(self) -> float:
        """Position of the last pantograph at the end of the run [m]; default: at most one span beyond the section."""
        geometry, (_, section_end) = self.line.geometry, self.recorded_section
        if self.file.run_out_m is not None:
            return section_end + self.file.run_out_m
        last_start, last_end = geometry.span((self.file.compared_spans or self.analysed_spans)[-1])
        # The first pantograph stops half a span before the end of the line.
        furthest = geometry.mid_span(geometry.spans) - self.offsets[-1]
        return max(section_end, min(section_end + last_end - last_start, furthest))

    @property
    def start_table(self) -> StartTable:
        """Start of the run: static equilibrium under the uplift forces, then full speed without a ramp."""
        return StartTable(place_m=self.start, ramp_m=0.0, state="equilibrium_under_uplift_forces")

    @property
    def start_positions(self) -> tuple[float, ...]:
        """Positions of the pantographs at the start of the run, in running order [m]."""
        return tuple(self.start + self.offsets[-1] - offset for offset in self.offsets)

    @property
    def end_positions(self) -> tuple[float, ...]:
        """Positions of the pantographs at the end of the run, in running order [m]."""
        return tuple(self.end + self.offsets[-1] - offset for offset in self.offsets)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the inputs that a system computes with; provenance, title, limits and readings are left out."""
        pantograph, unused = self.static_pantograph, self._keys_outside_digest
        inputs = {
            "line": _numbers(self.line),
            "pantographs": [_numbers(pantograph) for pantograph in self.pantographs],
            "case": _numbers(self.file, unused),
            "measured": None if pantograph is None else _numbers(pantograph),
        }
        if self.dampings and "study" not in unused:
            inputs["dampings"] = {name: _numbers(damping) for name, damping in self.dampings.items()}
        return json_digest(inputs)

    @property
    def _keys_outside_digest(self) -> set[str]:
        """Keys of the case file that are not used by a system, or that repeat the content of the line."""
        unused = {key for key in ("mass_drop", "study") if getattr(self.file, key) is None}
        if isinstance(self.file.study, DampingSensitivity):
            unused.add("study")  # The study runs the case unchanged.
        return {"limit", "reading", "line", "requires", "damping", "on_request", "edition", "superseded_by"} | unused

    @property
    def sourced_tables(self) -> dict[str, SourcedTable]:
        """All tables with a source, of the case, its line and its pantographs, by dotted name."""
        tables: dict[str, object] = {"case": self.file} | _tables("line", self.line)
        lists = {key: content for key, content in tables.items() if isinstance(content, tuple)}
        tables |= {f"{key} {i}": part for key, content in lists.items() for i, part in enumerate(content, 1)}
        for i, (use, model) in enumerate(zip(self.file.pantograph, self.pantographs, strict=True), 1):
            tables |= {f"pantograph {i}": use} | _tables(f"pantograph {i}", model)
        tables |= {"mass_drop": self.file.mass_drop, "study": self.file.study}
        tables |= {f"reading '{reading.id}'": reading for reading in self.file.reading}
        tables |= {f"damping '{name}'": damping for name, damping in self.dampings.items()}
        if self.static_pantograph is not None:
            tables |= _tables("pantograph", self.static_pantograph)
        return {name: table for name, table in tables.items() if isinstance(table, SourcedTable)}

    @property
    def inputs(self) -> tuple[InputProvenance, ...]:
        """Source of each group of inputs; the provisional keys of a group follow it."""
        inputs = []
        for name, table in self.sourced_tables.items():
            source = (table.source,) if isinstance(table.source, str) else tuple(table.source)
            inputs.append(InputProvenance(name, table.trust, source))
            inputs += [InputProvenance(f"{name}.{key}", "provisional", ("untraced",)) for key in table.provisional]
        return tuple(inputs)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the reader: first those of whole files, then those of their tables."""
        notes = [self.line.note, *(pantograph.note for pantograph in self.pantograph_files)]
        notes += [f"{name}: {table.note}" for name, table in self.sourced_tables.items() if table.note]
        return tuple(dict.fromkeys(note.strip() for note in notes if note))

    def with_limits(self, limits: tuple[Limit, ...]) -> "Case":
        """Same case with further limits; each replaces a limit with the same target."""
        merged = {limit.target: limit for limit in (*self.limits, *limits)}
        return replace(self, limits=tuple(merged.values()))

    def without_limits(self) -> "Case":
        """Same case without any limit."""
        return replace(self, file=self.file.model_copy(update={"limit": ()}), limits=())

    def with_reading(self, reading: Reading) -> "Case":
        """Same run of the case with another reading of its evaluation as its own."""
        changes: dict[str, object] = {} if reading.filter is None else {"filter": reading.filter}
        if reading.evaluated_m is not None:
            changes |= {"evaluated_m": reading.evaluated_m, "evaluated_spans": None, "compared_spans": None}
            changes["run_out_m"] = self.end - reading.evaluated_m[1]
        return replace(self, file=self.file.model_copy(update={**changes, "reading": ()}))

    def without_study(self) -> "Case":
        """Same case without its study, as a single run of a system."""
        return replace(self, file=self.file.model_copy(update={"study": None}), dampings={})

    def with_damping(self, name: str, damping: Damping) -> "Case":
        """Same case without limits and study, with another damping; the name of the damping ends its id."""
        file = self.file.model_copy(update={"id": f"{self.id}/{name}", "study": None, "limit": (), "requires": ()})
        line = self.line.model_copy(update={"damping": overlay_damping(self.line.damping, damping)})
        return replace(self, file=file, line=line, limits=(), dampings={})


def _tables(prefix: str, table: InputTable) -> dict[str, object]:
    """Keys of a table with their content, by dotted name; those of a sourced table follow it."""
    tables: dict[str, object] = {}
    for name in type(table).model_fields:
        content = tables[f"{prefix}.{name}"] = getattr(table, name)
        if isinstance(content, SourcedTable):
            tables |= _tables(f"{prefix}.{name}", content)
    return tables


def _numbers(table: InputTable, exclude: set[str] | None = None) -> object:
    """Content of a table without provenance and names, so that a corrected source does not change the digest."""
    return drop_keys(table.model_dump(mode="json", exclude=exclude), PROVENANCE | {"title", "id", "model"})


def content_digest(table: InputTable) -> str:
    """SHA-256 of a line or pantograph as a system computes with it; title and provenance are left out."""
    return json_digest(_numbers(table))


def json_digest(tree: object) -> str:
    """SHA-256 of nested lists, dictionaries, text and numbers, independent of the order of keys."""
    text = json.dumps(tree, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return "sha256:" + hashlib.sha256(text.encode()).hexdigest()


def drop_keys(tree: object, keys: frozenset[str]) -> object:
    """Copy of nested tables and lists without certain keys, at all levels."""
    if isinstance(tree, dict):
        return {key: drop_keys(value, keys) for key, value in tree.items() if key not in keys}
    if isinstance(tree, list):
        return [drop_keys(value, keys) for value in tree]
    return tree


# Features of a case: the parts of its line, pantographs and run that a simulator must not neglect.
RUN_FEATURES: dict[str, Callable[[Case], bool]] = {
    "applied_forces": lambda case: any(isinstance(force, AppliedForces) for force in case.law_forces.values()),
    "line_at_rest": lambda case: case.is_static,
    "mass_drop": lambda case: case.file.mass_drop is not None,
    "several_pantographs": lambda case: len(case.pantographs) > 1,
    "uplift_force_tuning": lambda case: any(force.target_mean_force is not None for force in case.lift_forces),
}
"""Features of the run of a case, and whether a case uses them."""


def list_case_features(case: Case) -> list[str]:
    """Features that a case uses, in alphabetic order: of its line, its pantographs and its run."""
    features = {name for table in (case.line, *case.pantographs) for name in list_features(table)}
    return sorted(features | {name for name, is_used in RUN_FEATURES.items() if is_used(case)})


def find_missing_features(case: Case, simulated: Collection[str] | None) -> str | None:
    """Reason to skip a case because a simulator neglects a feature of it; None if it simulates all of them.

    Args:
        case: Case to be simulated.
        simulated: Features that the simulator states; None: it states none.
    """
    if simulated is None:
        return f"the system does not list the features that it simulates, see {DocumentationPage.SYSTEMS}"
    missing = [name for name in list_case_features(case) if name not in simulated]
    return f"the system does not simulate {', '.join(missing)}" if missing else None
