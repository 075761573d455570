"""Dossier: everything that the EN 50318 procedure needs for one simulator and one line, in one TOML file."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field

from pantocheck.conformance.input_files.cross_checks import Problems, cross_check
from pantocheck.conformance.input_files.sourced_table import InputTable, validation_problem
from pantocheck.conformance.input_files.suggestions import suggest_names
from pantocheck.conformance.input_files.trust import Trust
from pantocheck.conformance.procedure.dossier_tables import (
    EntryNames,
    LineEntry,
    LineTestTable,
    PantographEntry,
    ParameterTable,
    ReferenceTable,
    ValidityTable,
)
from pantocheck.conformance.procedure.run_pair import PairTable, RecordRun
from pantocheck.conformance.results.procedure_format import STEP_NAMES, StepName
from pantocheck.conformance.systems.system_choice import TIMEOUT_S


class DossierFile(InputTable):
    """Dossier of the EN 50318 procedure."""

    schema_: Annotated[Literal["pantocheck.dossier/1"], Field(alias="schema")]
    """Version of the format: "pantocheck.dossier/1"."""
    title: Annotated[str, Field(min_length=1, max_length=200)]
    """Title of the certificate."""
    system: Annotated[str, Field(max_length=2000)]
    """Builtin, record:DIR or command:PROGRAM ARGUMENTS."""
    timeout_s: Annotated[float, Field(gt=0)] = TIMEOUT_S
    """Time limit of a program for a case [s]."""
    trust: Trust = "secondary"
    """Lowest trust of the limits and tolerances that count."""
    required: Annotated[tuple[StepName, ...], Field(strict=False, min_length=1)] = STEP_NAMES
    """Steps that decide the verdict; the others are for information."""
    accept_unverified: EntryNames = ()
    """Names of systems whose unverified records may pass."""
    note: Annotated[str | None, Field(max_length=4000)] = None
    """Remark for the reader."""
    pantograph: Annotated[tuple[PantographEntry, ...], Field(strict=False, max_length=20)] = ()
    line: Annotated[tuple[LineEntry, ...], Field(strict=False, max_length=20)] = ()
    parameters: ParameterTable = ParameterTable()
    reference: ReferenceTable = ReferenceTable()
    line_test: LineTestTable = LineTestTable()
    pair: Annotated[tuple[PairTable, ...], Field(strict=False, max_length=1000)] = ()
    validity: ValidityTable = ValidityTable()

    @cross_check
    def _check_names(self) -> Problems:
        tables: tuple[tuple[str, Sequence[Any]], ...] = (
            ("pantograph", self.pantograph), ("line", self.line), ("pair", self.pair)
        )  # fmt: skip
        for key, entries in tables:
            counts = Counter(entry.name for entry in entries)
            for i, entry in enumerate(entries, 1):
                if counts[entry.name] > 1:
                    yield validation_problem(
                        f"{key}[{i}].name",
                        f"{entry.name!r} occurs {counts[entry.name]} times",
                        "Give each its own name.",
                    )

    @cross_check
    def _check_references(self) -> Problems:
        lines, pantographs = ([entry.name for entry in entries] for entries in (self.line, self.pantograph))
        for key, name, kind in self._list_references():
            known = lines if kind == "line" else pantographs
            if name not in known:
                hint = suggest_names(name, known) if known else f"Add a table [[{kind}]] with this name."
                yield validation_problem(key, f"there is no {kind} {name!r} in this dossier", hint)

    def _list_references(self) -> Iterator[tuple[str, str, str]]:
        """Key, name and kind of every reference to a line or pantograph of the dossier."""
        for i, pair in enumerate(self.pair, 1):
            for key, run in (("simulated", pair.simulated), ("measured", pair.measured)):
                if isinstance(run, RecordRun):
                    yield f"pair[{i}].{key}.line", run.line, "line"
                    for k, name in enumerate(run.pantographs, 1):
                        yield f"pair[{i}].{key}.pantographs[{k}]", name, "pantograph"
        for k, name in enumerate(self.validity.lines, 1):
            yield f"validity.lines[{k}]", name, "line"
        for k, name in enumerate(self.validity.pantographs, 1):
            yield f"validity.pantographs[{k}]", name, "pantograph"
