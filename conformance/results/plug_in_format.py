"""Plug-ins that took part in the result of a case, in results.json."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import Field

from pantocheck.conformance.input_files.table_formats import find_plug_in_reader
from pantocheck.conformance.plug_ins.plug_in import PlugIn, PlugInKind, find_plug_in
from pantocheck.conformance.quantities.plug_in_quantity import list_own_quantities, select_own
from pantocheck.conformance.results.results_part import ResultsPart


class PlugInFacts(ResultsPart):
    """Reader, quantity or system of another distribution."""

    kind: PlugInKind
    name: Annotated[str, Field(description="suffix of a file, name of a quantity, or name of a system")]
    distribution: str
    version: str
    definition: Annotated[str, Field(description="definition of a quantity; empty for a reader or system")] = ""


def list_used_plug_ins(table: str | None, quantities: Iterable[str]) -> list[PlugInFacts] | None:
    """Reader of a record and quantities that other distributions offer; None without any.

    Parameters
    ----------
    table : str or None
        Name of the table of the record; None without one.
    quantities : iterable of str
        Names of the limited quantities.
    """
    reader = None if table is None else find_plug_in_reader(Path(table))
    facts = [] if reader is None else [describe_plug_in(reader)]
    for quantity in list_own_quantities(select_own(quantities)):
        if (plug_in := find_plug_in("quantity", quantity.name)) is not None:
            facts.append(describe_plug_in(plug_in, quantity.definition))
    return facts or None


def describe_plug_in(plug_in: PlugIn, definition: str = "") -> PlugInFacts:
    """Facts on a plug-in, with the definition of a quantity."""
    return PlugInFacts(
        kind=plug_in.kind,
        name=plug_in.name,
        distribution=plug_in.distribution,
        version=plug_in.version,
        definition=definition,
    )
