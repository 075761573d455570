"""Systems that are wrong on purpose, each in one way that has happened to somebody."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.records.record import Record
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.outcome import Delivered, Outcome
from pantocheck.conformance.simulation.case_run import run_passage
from pantocheck.conformance.simulation.catenary_model import build_catenary
from pantocheck.conformance.simulation.static_quantities import compute_static_quantities
from pantocheck.conformance.systems.record_folder import open_record_folder
from pantocheck.conformance.systems.reference_simulator import ReferenceSimulator
from pantocheck.model import discretise, never_slack

MakeMutant = Callable[[Case, Record], Outcome]

SAMPLE_CHANNELS = ("time", "position", "force", "contact_height", "support_uplift")


@dataclass(frozen=True)
class Mutant:
    """A system that is wrong.

    Parameters
    ----------
    name : str
        Short.
    wrong : str
        What is wrong with it, one sentence.
    make : MakeMutant
        Gives what it delivers, from the case and the right record.
    caught_by : Literal[coverage, support passing, roll-off, dynamics, limits, record file] or None
        The check that must catch it; `limits`: those of the case alone; None: a mild fault that may pass.
    """

    name: str
    wrong: str
    make: MakeMutant
    caught_by: Literal["coverage", "support passing", "roll-off", "dynamics", "limits", "record file"] | None


def _changed(**change: Callable[[Case, Record], Any]) -> MakeMutant:
    """The right record with some of its fields replaced."""
    return lambda case, record: Delivered(replace(record, **{name: of(case, record) for name, of in change.items()}))


def _filtered(order: int) -> MakeMutant:
    """The force through a zero-phase filter of another order at the cut-off of the case, and said to be filtered."""

    def make(case: Case, record: Record) -> Outcome:
        low_pass = replace(case.file.filter.low_pass, order=order)
        force = np.array([low_pass(force, record.rate) for force in record.force])
        return Delivered(replace(record, force=force, filter_applied_Hz=low_pass.cutoff_Hz))

    return make


def _late(seconds: float) -> MakeMutant:
    """The force held back against everything else; what runs over the end comes in at the beginning."""
    return _changed(force=lambda _, record: np.roll(record.force, round(seconds * record.rate), axis=1))


def _coarse(element: float) -> MakeMutant:
    def make(case: Case, record: Record) -> Outcome:
        discretisation = case.file.discretisation.model_copy(update={"element_m": element})
        file = case.file.model_copy(update={"discretisation": discretisation})
        return ReferenceSimulator().run_unrefined(replace(case, file=file))

    return make


def _bilateral(case: Case, record: Record) -> Outcome:
    steps = case.file.discretisation
    line = never_slack(discretise(build_catenary(case.line), steps.element_m))
    passage = run_passage(case, line, steps)
    return Delivered(passage.record, compute_static_quantities(case, line), passage.run)


def _cut(case: Case, record: Record) -> Outcome:
    """The record ends in the middle of the analysis section."""
    n = int(np.searchsorted(record.position[0], np.mean(case.analysis_section)))
    channels = {name: getattr(record, name) for name in SAMPLE_CHANNELS}
    return Delivered(replace(record, **{k: value[..., :n] for k, value in channels.items() if value is not None}))


def _damaged(case: Case, record: Record) -> Outcome:
    """The file of the record lost its last half; the sidecar is whole."""
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
        _changed(force=lambda _, record: 1.05 * record.force),
        "dynamics",
    ),
    Mutant(
        "unfiltered",
        "The record states the filter of the case, but its force is unfiltered.",
        _changed(filter_applied_Hz=lambda case, _: case.file.filter.cutoff_Hz),
        "roll-off",
    ),
    Mutant("filter order 2", "The order of the filter is 2 instead of 6.", _filtered(2), "roll-off"),
    Mutant("time shift", "The force lags the other channels by 0.1 s.", _late(0.1), "dynamics"),
    Mutant(
        "position shift",
        "The positions are shifted by 10 m against all other channels.",
        _changed(position=lambda _, record: record.position + 10.0),
        "support passing",
    ),
    Mutant("no slackening", "Droppers push as well as they pull.", _bilateral, "limits"),
    Mutant(
        "units x1000",
        "The force is in millinewtons.",
        _changed(force=lambda _, record: 1000 * record.force),
        "dynamics",
    ),
    Mutant(
        "uplift in mm",
        "The uplift of the supports is in millimetres.",
        _changed(support_uplift=lambda _, record: None if (u := record.support_uplift) is None else 1000 * u),
        "limits",
    ),
    Mutant("coarse mesh", "Elements are 4 m long.", _coarse(4.0), "limits"),
    Mutant("truncated record", "The record ends in the middle of the analysis section.", _cut, "coverage"),
    Mutant("truncated file", "The second half of the table of samples is missing.", _damaged, "record file"),
)
"""Those that must not pass."""

MILD: tuple[Mutant, ...] = (
    Mutant("gain 1.02", "The force is 2 % too large.", _changed(force=lambda _, record: 1.02 * record.force), None),
    Mutant("filter order 4", "The order of the filter is 4 instead of 6.", _filtered(4), None),
    Mutant("time shift 5 ms", "The force lags by 5 ms.", _late(0.005), None),
    Mutant(
        "time shift, force alone",
        "The force lags by 0.1 s, and the record has no contact height.",
        lambda case, record: Delivered(
            replace(record, force=np.roll(record.force, round(0.1 * record.rate), axis=1), contact_height=None)
        ),
        None,
    ),
    Mutant("mesh of 2 m", "Elements are 2 m long.", _coarse(2.0), None),
)
"""Smaller faults, to show where the suite stops seeing: they may pass."""
