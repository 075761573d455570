"""Systems with one deliberate fault each, of a kind that has occurred in practice."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.case_run import run_passage
from pantocheck.conformance.runs.record_folder import open_record_folder
from pantocheck.conformance.runs.reference_simulator import ReferenceSimulator
from pantocheck.conformance.runs.static_quantities import compute_static_quantities
from pantocheck.conformance.runs.system import Delivered, Outcome
from pantocheck.model import discretise, make_droppers_bilateral

RunMutant = Callable[[Case, Record], Outcome]
"""Outcome of a faulty system on a case, made from the record of the reference simulator."""

SAMPLE_CHANNELS = ("time", "position", "force", "contact_height", "support_uplift")


@dataclass(frozen=True)
class Mutant:
    """A system with a fault."""

    name: str
    """Short name."""
    fault: str
    """The fault in one sentence."""
    run: RunMutant
    """Run of the faulty system."""
    expected_check: Literal["coverage", "support passing", "roll-off", "dynamics", "limits", "record file"] | None
    """Check that must detect the fault; `limits`: the limits of the case; None: a mild fault, which may remain
    undetected.
    """


def _replace_channels(**changes: Callable[[Case, Record], Any]) -> RunMutant:
    """The record with some of its fields replaced."""
    return lambda case, record: Delivered(
        replace(record, **{name: change(case, record) for name, change in changes.items()})
    )


def _filter_force(order: int) -> RunMutant:
    """The record states the filter of the case, but its force passed a zero-phase filter of another order."""

    def run(case: Case, record: Record) -> Outcome:
        low_pass = case.file.filter.model_copy(update={"order": order})
        force = np.array([low_pass(force, record.rate) for force in record.force])
        return Delivered(replace(record, force=force, filter_applied_Hz=low_pass.cutoff_Hz))

    return run


def _filter_force_and_height(cutoff: float) -> RunMutant:
    """Force and contact height passed the same zero-phase filter, which the record does not state."""

    def run(case: Case, record: Record) -> Outcome:
        low_pass = case.file.filter.change_cutoff(cutoff)
        changes: dict[str, Any] = {
            name: np.array([low_pass(channel, record.rate) for channel in channels])
            for name in ("force", "contact_height")
            if (channels := getattr(record, name)) is not None
        }
        return Delivered(replace(record, **changes))

    return run


def _scale_force(factor: float) -> RunMutant:
    return _replace_channels(force=lambda _, record: factor * record.force)


def _delay_force(seconds: float, **changes: Callable[[Case, Record], Any]) -> RunMutant:
    """The force is late against all other channels; its last samples move to the start."""
    return _replace_channels(
        force=lambda _, record: np.roll(record.force, round(seconds * record.rate), axis=1), **changes
    )


def _coarsen_mesh(element: float) -> RunMutant:
    def run(case: Case, record: Record) -> Outcome:
        discretisation = case.file.discretisation.model_copy(update={"element_m": element})
        file = case.file.model_copy(update={"discretisation": discretisation})
        return ReferenceSimulator().run_unrefined(replace(case, file=file))

    return run


def _run_bilateral_droppers(case: Case, record: Record) -> Outcome:
    discretisation = case.file.discretisation
    line = make_droppers_bilateral(discretise(build_catenary(case.line), discretisation.element_m))
    passage = run_passage(case, line, discretisation)
    return Delivered(passage.record, compute_static_quantities(case, line), passage.run)


def _truncate_record(case: Case, record: Record) -> Outcome:
    """The record ends in the middle of the analysis section."""
    n = int(np.searchsorted(record.position[0], np.mean(case.analysis_section)))
    channels = {name: getattr(record, name) for name in SAMPLE_CHANNELS}
    return Delivered(replace(record, **{k: value[..., :n] for k, value in channels.items() if value is not None}))


def _truncate_file(case: Case, record: Record) -> Outcome:
    """The second half of the table is missing; the sidecar is complete."""
    with tempfile.TemporaryDirectory(prefix="pantocheck-") as name:
        table = Path(name) / "record.csv"
        write_record(table, record, case.id)
        content = table.read_bytes()
        table.write_bytes(content[: content.rfind(b"\n", 0, len(content) // 2) + 1])
        return open_record_folder(Path(name)).run(case)


MUTANTS: tuple[Mutant, ...] = (
    Mutant(
        "gain 1.05",
        "The force is 5 % too large, as from a wrongly calibrated load cell.",
        _scale_force(1.05),
        "dynamics",
    ),
    Mutant(
        "unfiltered",
        "The record states the filter of the case, but its force is unfiltered.",
        _replace_channels(filter_applied_Hz=lambda case, _: case.file.filter.cutoff_Hz),
        "roll-off",
    ),
    Mutant("filter order 2", "The order of the filter is 2 instead of 6.", _filter_force(2), "roll-off"),
    Mutant("time shift", "The force lags the other channels by 0.1 s.", _delay_force(0.1), "dynamics"),
    Mutant(
        "position shift",
        "The positions are shifted by 10 m against all other channels.",
        _replace_channels(position=lambda _, record: record.position + 10.0),
        "support passing",
    ),
    Mutant("no slackening", "Droppers push as well as they pull.", _run_bilateral_droppers, "limits"),
    Mutant("units x1000", "The force is in millinewtons.", _scale_force(1000), "dynamics"),
    Mutant(
        "uplift in mm",
        "The uplift of the supports is in millimetres.",
        _replace_channels(support_uplift=lambda _, record: None if (u := record.support_uplift) is None else 1000 * u),
        "limits",
    ),
    Mutant("coarse mesh", "An element spans the distance between droppers.", _coarsen_mesh(8.0), "limits"),
    Mutant("truncated record", "The record ends in the middle of the analysis section.", _truncate_record, "coverage"),
    Mutant("truncated file", "The second half of the table of samples is missing.", _truncate_file, "record file"),
)
"""Mutants that must be detected."""

MILD: tuple[Mutant, ...] = (
    Mutant("gain 1.02", "The force is 2 % too large.", _scale_force(1.02), None),
    Mutant("filter order 4", "The order of the filter is 4 instead of 6.", _filter_force(4), None),
    Mutant(
        "filter at 10 Hz",
        "Force and contact height passed the same filter at 10 Hz, which is not stated.",
        _filter_force_and_height(10.0),
        None,
    ),
    Mutant("time shift 5 ms", "The force lags by 5 ms.", _delay_force(0.005), None),
    Mutant(
        "time shift, force alone",
        "The force lags by 0.1 s, and the record has no contact height.",
        _delay_force(0.1, contact_height=lambda *_: None),
        None,
    ),
    Mutant("mesh of 4 m", "Elements are 4 m long.", _coarsen_mesh(4.0), None),
)
"""Smaller faults, which show the limit of detection."""
