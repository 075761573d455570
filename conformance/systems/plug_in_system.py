"""System of another distribution, in the same process; its data are checked like those of any foreign system."""

import copy
import time
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from pantocheck.conformance.array_types import RealArray
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.input_files.documentation_pages import DocumentationPage
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.plug_ins.plug_in import PlugIn, find_plug_in
from pantocheck.conformance.plug_ins.plug_in_loading import guard_plug_in, load_plug_in
from pantocheck.conformance.records.record import Record, RecordInvalid
from pantocheck.conformance.records.sidecar_tables import RunTable
from pantocheck.conformance.results.outcome import Delivered, Errored, Outcome, Skipped
from pantocheck.conformance.systems.plug_in_protocol import CaseSkipped, CaseSystem, DeliveredPassage, SystemFactory

LONGEST_SYSTEM_NAME = 100
"""Largest number of characters of the name and version of a system."""


@dataclass(frozen=True)
class PlugInSystem:
    """System of another distribution. It holds plain data only, because other processes receive it.

    Parameters
    ----------
    plug_in : PlugIn
        Entry point.
    text : str
        Text behind the colon of `--system`.
    name, version : str
        Name and version that the system states.
    """

    plug_in: PlugIn
    text: str
    name: str
    version: str
    kind: Literal["plugin"] = "plugin"

    def run(self, case: Case) -> Outcome:
        """Run a case; an exception of the plug-in becomes the verdict `error` of this case only."""
        from pantocheck.conformance.systems.command.case_message import (
            build_case_message,  # derived values need the model
        )

        message, started = build_case_message(case), time.perf_counter()
        try:
            with guard_plug_in(self.plug_in):
                # The plug-in gets a copy: it cannot change what the case is graded by.
                answer = _open_system(self.plug_in, self.text).run(copy.deepcopy(message))
                return self._convert(answer, case, time.perf_counter() - started)
        except InputError as error:
            return Errored(f"{error.where} {error.found}")

    def _convert(self, answer: object, case: Case, wall: float) -> Outcome:
        if isinstance(answer, CaseSkipped):
            return Skipped(_clean_line(answer.reason))
        if not isinstance(answer, DeliveredPassage):
            raise TypeError(f"run returned a {type(answer).__name__} in place of a DeliveredPassage or CaseSkipped")
        notes = tuple(_clean_line(note) for note in answer.notes)
        static = {str(name): float(value) for name, value in answer.static.items()}
        try:
            record = None if case.is_static else _build_record(answer, case)
        except RecordInvalid as error:
            return Errored(f"{self.plug_in.text}: {error}")
        run = RunTable(wall_s=wall)
        return Delivered(record, dict(static), run, notes, case_digest=case.digest)


def open_plug_in_system(name: str, text: str) -> PlugInSystem | None:
    """Open a system of another distribution; None if no distribution offers the name.

    Raises
    ------
    InputError
        Two distributions offer it, or it cannot be opened.
    """
    plug_in = find_plug_in("system", name)
    if plug_in is None:
        return None
    system = _open_system(plug_in, text)
    for key, value in (("name", system.name), ("version", system.version)):
        if not isinstance(value, str) or not value.isprintable() or len(value) > LONGEST_SYSTEM_NAME:
            raise InputError(plug_in.text, f"{key} of the system is {value!r:.60}", "Give a printable text.")
    return PlugInSystem(plug_in, text, system.name, system.version)


def _open_system(plug_in: PlugIn, text: str) -> CaseSystem:
    factory = load_plug_in(plug_in, SystemFactory)
    with guard_plug_in(plug_in):
        system: object = factory.open(text)
    if not isinstance(system, CaseSystem):
        found = f"open returned a {type(system).__name__}"
        raise InputError(plug_in.text, found, f"It must return a CaseSystem. See {DocumentationPage.EXTENDING}.")
    return system


def _build_record(passage: DeliveredPassage, case: Case) -> Record:
    return Record(
        time=_array(passage.time_s),
        speed=case.speed,
        position=np.atleast_2d(_array(passage.position_m)),
        force=np.atleast_2d(_array(passage.force_N)),
        evaluated=case.analysis_section,
        filter_applied_Hz=passage.filter_applied_Hz,
        contact_height=None if passage.contact_height_m is None else np.atleast_2d(_array(passage.contact_height_m)),
        support_position=None if passage.support_position_m is None else _array(passage.support_position_m),
        support_uplift=None if passage.support_uplift_m is None else np.atleast_2d(_array(passage.support_uplift_m)),
    )


def _clean_line(text: object) -> str:
    """One printable line of at most 300 characters."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(str(text).split()))[:300]


def _array(values: ArrayLike) -> RealArray:
    """Own copy: the plug-in cannot change a record after its delivery."""
    return np.array(values, dtype=np.float64)
