"""Runs on changed copies of the AC simple line, on a coarse mesh."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import load_case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_signals import RecordSignals
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.check import CheckName, Finding
from pantocheck.conformance.runs.record_checks import check_record
from pantocheck.model import History, Passage, discretise, simulate_passage
from pantocheck.model.discretisation.discretised_line import DiscretisedLine


def build_case(
    speed: float = 250.0,
    force: float = 150.0,
    pantographs: int = 2,
    spacing: float = 100.0,
    spans: tuple[int, int] = (5, 7),
    **changes: dict[str, Any],
) -> Case:
    """AC simple with changed tables of line and pantograph."""
    base = load_case(library_folder() / "en50318-2018" / "ac-simple" / "320-twin.toml")

    def change(table: Any, name: str) -> Any:
        return table.model_copy(update=changes.get(name, {}))

    line, pantograph = base.line, base.pantographs[0]
    geometry = change(line.geometry.model_copy(update={"spans": 10}), "geometry")
    tables = {
        name: getattr(line.damping, name).model_copy(update=new) for name, new in changes.get("damping", {}).items()
    }
    line = line.model_copy(
        update={
            "geometry": geometry,
            "contact_wire": change(line.contact_wire, "wire"),
            "droppers": change(line.droppers, "droppers"),
            "damping": line.damping.model_copy(update=tables),
        }
    )
    pantograph = pantograph.model_copy(
        update={"contact": change(pantograph.contact, "contact"), "chain": change(pantograph.chain, "chain")}
    )
    use = base.file.pantograph[0].model_copy(update={"uplift_force_N": force, "target_mean_force_N": None})
    steps = base.file.discretisation.model_copy(update={"element_m": 1.0, "time_step_s": 0.002, "reach_m": None})
    file = base.file.model_copy(
        update={
            "speed_km_h": speed, "evaluated_spans": spans, "compared_spans": None, "pantograph": (use,) * pantographs,
            "spacing_m": (spacing,) * (pantographs - 1), "discretisation": steps,
        }
    )  # fmt: skip
    return replace(base, file=file, line=line, pantographs=(pantograph,) * pantographs, limits=())


def simulate(case: Case, run: Callable[[DiscretisedLine, Passage], History] = simulate_passage) -> Record:
    line = discretise(build_catenary(case.line), case.file.discretisation.element_m)
    forces = tuple(use.uplift_force_N or 0.0 for use in case.file.pantograph)
    passage = build_passage(case, line, case.file.discretisation, forces)
    return record_passage(case, passage, run(line, passage))


def read_signals(case: Case, record: Record) -> RecordSignals:
    return RecordSignals(record, case.file.filter, case.line.geometry.supports)


def list_problems(case: Case, signals: RecordSignals) -> dict[CheckName, Finding]:
    """Findings of the checks that do not confirm a record."""
    return {name: finding for name, finding in check_record(case, signals).items() if finding.kind != "confirmed"}


def list_kinds(case: Case, record: Record) -> dict[CheckName, str]:
    """Kind of every finding that does not confirm a record."""
    return {name: finding.kind for name, finding in list_problems(case, read_signals(case, record)).items()}
