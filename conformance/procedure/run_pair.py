"""Pairs of a dossier: a simulated run and the measured run of the same passage."""

from typing import Annotated

from pydantic import Discriminator, Field, Tag

from pantocheck.conformance.input_files.sourced_table import InputTable
from pantocheck.conformance.procedure.dossier_tables import EntryName, EntryNames, NamedFile


class CaseRun(InputTable):
    """Simulated run: a case that the system under test runs."""

    case: EntryName
    """Id or path of a case."""
    direction: EntryName
    """Direction of the train, in any words that both runs share."""


class RecordRun(InputTable):
    """Run in a record, simulated by the system under test or measured."""

    record: NamedFile
    """record: its sidecar or its table."""
    line: EntryName
    """Name of the line in this dossier."""
    pantographs: Annotated[EntryNames, Field(min_length=1)]
    """Names of the pantographs in running order."""
    direction: EntryName
    """Direction of the train, in any words that both runs share."""


def _kind_of_run(run: object) -> str:
    """Kind of a simulated run, which pydantic validates and reports alone."""
    if isinstance(run, dict):
        return "RecordRun" if "record" in run else "CaseRun"
    return type(run).__name__


SimulatedSource = Annotated[
    Annotated[CaseRun, Tag("CaseRun")] | Annotated[RecordRun, Tag("RecordRun")], Discriminator(_kind_of_run)
]


class PairTable(InputTable):
    """Simulated run and measured run of the same passage."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9._-]+$", max_length=100)]
    """Name of the pair."""
    simulated: SimulatedSource
    """A case that the system runs, or a record."""
    measured: RecordRun
