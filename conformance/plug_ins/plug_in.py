"""Plug-ins: what other installed distributions offer by entry points, listed without running their code."""

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Literal, get_args

from pantocheck.conformance.input_files.input_error import InputError

PlugInKind = Literal["cases", "reader", "quantity", "system"]
"""Kind of a plug-in: folder of cases, reader of a file format, quantity of a record, or system under test."""

PLUG_IN_KINDS: tuple[PlugInKind, ...] = get_args(PlugInKind)

GROUPS: dict[PlugInKind, str] = {
    "cases": "pantocheck.cases",
    "reader": "pantocheck.readers",
    "quantity": "pantocheck.quantities",
    "system": "pantocheck.systems",
}
"""Groups of entry points."""

LONGEST_TEXT = 100
"""Largest number of characters of a name or version that is shown; metadata are written by strangers."""


@dataclass(frozen=True, order=True)
class PlugIn:
    """An entry point of an installed distribution.

    Parameters
    ----------
    kind : {"cases", "reader", "quantity", "system"}
        Kind of the plug-in.
    name : str
        Name of the entry point: suffix of a file without its dot, name of a quantity or of a system; free for cases.
    distribution, version : str
        Distribution that offers it.
    value : str
        Object that the entry point names, as `package.module:object`.
    """

    kind: PlugInKind
    name: str
    distribution: str
    version: str
    value: str

    @property
    def text(self) -> str:
        """Name in messages and reports, such as `reader 'acq' of acme-lines 1.0`."""
        return f"{self.kind} '{self.name}' of {self.distribution} {self.version}"


def list_plug_ins(kind: PlugInKind) -> list[PlugIn]:
    """Plug-ins of a kind, by name; the code of no distribution is run."""
    return sorted(_list_entries(kind))


def _list_entries(kind: PlugInKind) -> Iterator[PlugIn]:
    for entry in entry_points(group=GROUPS[kind]):
        yield PlugIn(kind, entry.name[:LONGEST_TEXT], *_identify_distribution(entry), entry.value)


def _identify_distribution(entry: EntryPoint) -> tuple[str, str]:
    """Name and version of the distribution of an entry point; broken metadata may lack them."""
    stated = {} if entry.dist is None else entry.dist.metadata.json
    name, version = (" ".join(str(stated.get(key) or "unknown").split()) for key in ("name", "version"))
    return name[:LONGEST_TEXT], version[:LONGEST_TEXT]


def find_plug_in(kind: PlugInKind, name: str) -> PlugIn | None:
    """Plug-in of a kind and name; None if no distribution offers it.

    Raises
    ------
    InputError
        Two distributions offer it.
    """
    found = [plug_in for plug_in in list_plug_ins(kind) if plug_in.name == name]
    if len(found) > 1:
        raise InputError(
            f"plug-ins, {kind} '{name}'",
            f"offered by {' and by '.join(f'{each.distribution} {each.version}' for each in found)}",
            "Uninstall one of them.",
        )
    return found[0] if found else None
