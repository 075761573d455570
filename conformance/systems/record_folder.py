"""A folder of records as a system: every record that names a case is graded as that case's run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.toml_file import read_model, read_toml
from pantocheck.conformance.errors import InputError
from pantocheck.conformance.record_files.reading import read_record
from pantocheck.conformance.record_files.sidecar import SCHEMA, Sidecar
from pantocheck.conformance.systems import Outcome


@dataclass(frozen=True)
class RecordFolder:
    """Records of other simulators, or of measurements, found by the case their sidecars name.

    Parameters
    ----------
    name, version : of what the records come from, if their sidecars agree; else the folder's name
    sidecars : case id and sidecar of every record
    """

    name: str
    version: str
    sidecars: tuple[tuple[str, Path], ...]
    kind: Literal["record"] = "record"

    def run(self, case: Case) -> Outcome:
        """Read the record of a case; a case without one is skipped."""
        path = dict(self.sidecars).get(case.id)
        if path is None:
            return Outcome(skipped="there is no record of this case")
        record, sidecar = read_record(path)
        run = sidecar.run
        return Outcome(record, {}, run.simulated_s, run.wall_s, run.dt_s, run.element_m)


def record_folder(folder: Path) -> RecordFolder:
    """Find the records of a folder and the folders below it.

    Raises
    ------
    InputError : there is no such folder or no record in it, a sidecar is wrong, or two are of the same case
    """
    where = f"system record:{folder}"
    if not folder.is_dir():
        raise InputError(where, "there is no such folder", "Give the folder that holds records and their sidecars.")
    found: dict[str, Path] = {}
    systems = set()
    for path in sorted(folder.rglob("*.toml")):
        if read_toml(path, "sidecar").get("schema") != SCHEMA:
            continue
        sidecar = read_model(path, Sidecar, "sidecar")
        if sidecar.case is None:
            continue
        if sidecar.case in found:
            raise InputError(
                where,
                f"{path.name} and {found[sidecar.case].name} are both of case {sidecar.case}",
                "Keep one record of each case.",
            )
        found[sidecar.case] = path
        systems.add((sidecar.system.name, sidecar.system.version) if sidecar.system else (folder.resolve().name, ""))
    if not found:
        raise InputError(
            where, "no sidecar in it names a case", f'A sidecar says schema = "{SCHEMA}" and case = "...".'
        )
    name, version = systems.pop() if len(systems) == 1 else (folder.resolve().name, "")
    return RecordFolder(name, version, tuple(found.items()))
