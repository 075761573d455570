"""A case as systems under test get it: the case file with its line and pantographs read."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from pantocheck.conformance.cases.case_file import CaseFile
from pantocheck.conformance.cases.damping_file import Damping, overlay_damping
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.cases.line_file import LineFile
from pantocheck.conformance.cases.pantograph_file import PantographFile
from pantocheck.conformance.cases.study_tables import DampingSensitivity
from pantocheck.conformance.input_files.sourced_table import PROVENANCE, SourcedTable
from pantocheck.conformance.input_files.trust import Trust


@dataclass(frozen=True)
class InputProvenance:
    """Where a group of inputs comes from.

    Parameters
    ----------
    group : str
        Dotted name of the table, or of one key of it.
    trust, source : Trust or tuple[str, ...]
        As the file says; source keys.
    """

    group: str
    trust: Trust
    source: tuple[str, ...]


@dataclass(frozen=True)
class Case:
    """What is simulated, what is evaluated, and the limits.

    Parameters
    ----------
    file : CaseFile
        The case file.
    line : LineFile
        Its line.
    pantographs : tuple[PantographFile, ...]
        One per [[pantograph]] table, in running order.
    limits : tuple[Limit, ...]
        Those of the file, or a user's in their place.
    static_pantograph : PantographFile or None
        Pantograph whose apparent mass a static case takes.
    dampings : Mapping[str, Damping]
        Other damping models that a study or a comparison needs, by name.
    """

    file: CaseFile
    line: LineFile
    pantographs: tuple[PantographFile, ...]
    limits: tuple[Limit, ...]
    static_pantograph: PantographFile | None = None
    dampings: Mapping[str, Damping] = field(default_factory=dict)

    @property
    def pantograph_files(self) -> tuple[PantographFile, ...]:
        """Pantographs of the run, or the one of a static case."""
        return self.pantographs if self.static_pantograph is None else (*self.pantographs, self.static_pantograph)

    @property
    def id(self) -> str:
        """Path-like name."""
        return self.file.id

    @property
    def is_static(self) -> bool:
        """Whether nothing runs: a check of the line at rest."""
        return self.file.speed_km_h is None

    @property
    def speed(self) -> float:
        """Speed of the train [m/s]; 0 for a static case."""
        return (self.file.speed_km_h or 0.0) / 3.6

    @property
    def analysis_section(self) -> tuple[float, float]:
        """Start and end of the evaluated stretch [m]; the line begins at 0."""
        spans = self.file.evaluated_spans or (1, self.line.geometry.spans)
        return self.line.geometry.section(spans[0], spans[-1])

    @property
    def shifted_sections(self) -> tuple[tuple[float, float], ...]:
        """The evaluated stretch shifted span by span along the compared spans, itself among them [m]."""
        if self.file.compared_spans is None or self.file.evaluated_spans is None:
            return ()
        (first, last), spans = self.file.compared_spans, self.file.evaluated_spans
        further = spans[-1] - spans[0]
        return tuple(self.line.geometry.section(i, i + further) for i in range(first, last + 1 - further))

    @property
    def recorded_section(self) -> tuple[float, float]:
        """Start and end of the section that a record has to cover: the compared spans, or the analysis section [m]."""
        if self.file.compared_spans is None:
            return self.analysis_section
        return self.line.geometry.section(*self.file.compared_spans)

    @property
    def offsets(self) -> tuple[float, ...]:
        """How far each pantograph runs behind the first [m]."""
        spacing = self.file.spacing_m or ()
        return tuple(sum(spacing[:i]) for i in range(len(self.pantographs)))

    @property
    def start(self) -> float:
        """Where the last pantograph is at the beginning of a run [m]."""
        return self.line.geometry.span(1)[1] if self.file.start_m is None else self.file.start_m

    @property
    def end(self) -> float:
        """Where the last pantograph is at the end of a run [m]; by default up to a span past the evaluated stretch."""
        geometry, (_, section_end) = self.line.geometry, self.recorded_section
        if self.file.run_out_m is not None:
            return section_end + self.file.run_out_m
        last_start, last_end = geometry.span((self.file.compared_spans or self.file.evaluated_spans or (1,))[-1])
        # The first pantograph stays on the line, half a span away from its end.
        furthest = geometry.mid_span(geometry.spans) - self.offsets[-1]
        return max(section_end, min(section_end + last_end - last_start, furthest))

    @property
    def start_positions(self) -> tuple[float, ...]:
        """Position of every pantograph at the beginning of a run, from the front [m]."""
        return tuple(self.start + self.offsets[-1] - offset for offset in self.offsets)

    @property
    def end_positions(self) -> tuple[float, ...]:
        """Position of every pantograph at the end of a run, from the front [m]."""
        return tuple(self.end + self.offsets[-1] - offset for offset in self.offsets)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of everything a system is told: the inputs without provenance, title and limits."""
        inputs = {
            "line": _numbers(self.line.model_dump(mode="json")),
            "pantographs": [_numbers(pantograph.model_dump(mode="json")) for pantograph in self.pantographs],
            "case": _numbers(self.file.model_dump(mode="json", exclude=self._not_told)),
            "measured": None
            if self.static_pantograph is None
            else _numbers(self.static_pantograph.model_dump(mode="json")),
        }
        if self.dampings and "study" not in self._not_told:
            inputs["dampings"] = {name: _numbers(d.model_dump(mode="json")) for name, d in self.dampings.items()}
        text = json.dumps(inputs, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return "sha256:" + hashlib.sha256(text.encode()).hexdigest()

    @property
    def _not_told(self) -> set[str]:
        """Keys of the file that tell a system nothing, or nothing that the line does not tell already."""
        unused = {key for key in ("mass_drop", "study") if getattr(self.file, key) is None}
        if isinstance(self.file.study, DampingSensitivity):
            unused.add("study")  # it runs the case as it is, and says more about it
        return {"limit", "line", "requires", "damping", "on_request"} | unused

    @property
    def sourced_tables(self) -> dict[str, SourcedTable]:
        """Every group of inputs that names its source, by dotted name: of the case, the line, and the pantographs."""
        tables: dict[str, object] = {"case": self.file}
        tables |= {f"line.{name}": getattr(self.line, name) for name in type(self.line).model_fields}
        for i, (use, model) in enumerate(zip(self.file.pantograph, self.pantographs, strict=True), 1):
            tables |= {f"pantograph {i}": use}
            tables |= {f"pantograph {i}.{name}": getattr(model, name) for name in type(model).model_fields}
        tables |= {"mass_drop": self.file.mass_drop, "study": self.file.study}
        tables |= {f"damping '{name}'": damping for name, damping in self.dampings.items()}
        if self.static_pantograph is not None:
            tables |= {
                f"pantograph.{name}": getattr(self.static_pantograph, name)
                for name in type(self.static_pantograph).model_fields
            }
        return {name: table for name, table in tables.items() if isinstance(table, SourcedTable)}

    @property
    def inputs(self) -> tuple[InputProvenance, ...]:
        """Where every group of inputs comes from; keys that are less certain than their group follow it."""
        found = []
        for name, table in self.sourced_tables.items():
            source = (table.source,) if isinstance(table.source, str) else tuple(table.source)
            found.append(InputProvenance(name, table.trust, source))
            found += [InputProvenance(f"{name}.{key}", "provisional", ("untraced",)) for key in table.provisional]
        return tuple(found)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the files want a reader to know: on the whole, then group by group."""
        notes = [self.line.note, *(pantograph.note for pantograph in self.pantograph_files)]
        notes += [f"{name}: {table.note}" for name, table in self.sourced_tables.items() if table.note]
        return tuple(dict.fromkeys(note.strip() for note in notes if note))

    def with_limits(self, limits: tuple[Limit, ...]) -> "Case":
        """The same case under other limits: one replaces that of the same quantity, the rest are added."""
        merged = {limit.target: limit for limit in (*self.limits, *limits)}
        return replace(self, limits=tuple(merged.values()))

    def without_study(self) -> "Case":
        """The same case as a system under test gets it: a plain run."""
        return replace(self, file=self.file.model_copy(update={"study": None}), dampings={})

    def with_damping(self, name: str, damping: Damping) -> "Case":
        """The same case without limits and study, another damping laid over its line; its id ends in the name."""
        file = self.file.model_copy(update={"id": f"{self.id}/{name}", "study": None, "limit": (), "requires": ()})
        line = self.line.model_copy(update={"damping": overlay_damping(self.line.damping, damping)})
        return replace(self, file=file, line=line, limits=(), dampings={})


_SAID_OF_NUMBERS = frozenset({*PROVENANCE, "title", "id", "model"})


def _numbers(tree: object) -> object:
    """A file without what is said about its numbers, so that a corrected source leaves the digest as it is."""
    return drop_keys(tree, _SAID_OF_NUMBERS)


def drop_keys(tree: object, keys: frozenset[str]) -> object:
    """Nested tables and lists without some keys, wherever they stand."""
    if isinstance(tree, dict):
        return {key: drop_keys(value, keys) for key, value in tree.items() if key not in keys}
    if isinstance(tree, list):
        return [drop_keys(value, keys) for value in tree]
    return tree
