"""Uses of a damaged file, each by its reader; verdicts that come out are checked."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from pantocheck.conformance.app.commands.sidecar_drafts import DescribedTable, draft_record_sidecar
from pantocheck.conformance.cases.library import overlay_limits, read_limits, select_cases
from pantocheck.conformance.cases.profile_file import load_profile
from pantocheck.conformance.comparison.profile_grading import assess_record
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import EVERY_CHANNEL, read_tables
from pantocheck.conformance.core.text_settings import TextSettings
from pantocheck.conformance.documents.recomputation import find_discrepancies
from pantocheck.conformance.drops.drop_reading import LARGEST_DROP, read_drop_records
from pantocheck.conformance.drops.line_comparison import compare_line
from pantocheck.conformance.drops.mode_matching import select_usable
from pantocheck.conformance.execution.runner import run_cases
from pantocheck.conformance.grading.assessed_record import load_assessed_record
from pantocheck.conformance.grading.baseline import compare_with_baseline, read_baseline
from pantocheck.conformance.line.catenary_model import build_catenary
from pantocheck.conformance.line.library_folder import library_folder
from pantocheck.conformance.records.channel_facts import find_time, list_channel_facts
from pantocheck.conformance.records.sidecar_tables import LineTable
from pantocheck.conformance.results.identified_modes import read_modes
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runs.protocol_messages import AnswerRefused, parse_message
from pantocheck.conformance.runs.record_folder import open_record_folder

CASE = "en50318-2002/250"
PASSING = library_folder() / "en50318-2002" / "known-passing-code"


class Falsehood(AssertionError):
    """A passing verdict that does not follow from the file: the one defect that a conformance suite must not have."""


def use_record(folder: Path) -> None:
    """Grade a record as the run of a case, and assess it."""
    try:
        system = open_record_folder(folder)
    except InputError:
        pass
    else:
        # `run` is called directly because the runner would hide an unexpected exception.
        (case,) = select_cases([CASE])
        with suppress(InputError):
            system.run(case)
        check(run_cases([case], system))
    profile = load_profile("acceptance-ac")
    check(assess_record(load_assessed_record(folder / "a.toml", profile, LineTable(wave_speed_m_s=120.0)), profile))


def use_logger(file: str) -> Callable[[Path], object]:
    """Describe the file of a logger, and assess its record."""

    def use(folder: Path) -> None:
        for table in read_tables(folder / file, EVERY_CHANNEL, LARGEST_DROP):
            part = DescribedTable(file, table.values.shape[0], list_channel_facts(table), find_time(table))
            draft_record_sidecar([part], TextSettings())
        profile = load_profile("acceptance-ac")
        check(assess_record(load_assessed_record(folder / file, profile, LineTable()), profile))

    return use


def use_digested(folder: Path) -> None:
    """Require that a table which contradicts its digest is refused."""
    use_record(folder)
    raise Falsehood("a table that contradicts its digest was read")


def use_limits(folder: Path) -> None:
    """Replace the limits of the case, and grade the passing code."""
    check(run_cases(overlay_limits(select_cases([CASE]), read_limits(folder / "l.toml")), open_record_folder(PASSING)))


def use_profile(folder: Path) -> None:
    """Assess a sound record by a damaged profile."""
    profile = load_profile(str(folder / "p.toml"))
    check(assess_record(load_assessed_record(folder / "a.toml", profile, LineTable(wave_speed_m_s=120.0)), profile))


def use_baseline(results: Results) -> Callable[[Path], None]:
    """Compare sound results with damaged ones; grade the damaged ones once more, as `verify` does."""

    def use(folder: Path) -> None:
        damaged_results = read_baseline(folder / "r.json")
        find_discrepancies(damaged_results)
        check(compare_with_baseline(results, damaged_results, 1.0, "r.json"))

    return use


def use_drop(file: str) -> Callable[[Path], object]:
    """Read a record of a mass drop."""

    def use(folder: Path) -> None:
        for record in read_drop_records(folder / file):
            if not (np.isfinite(record.signals).all() and np.isfinite(record.time).all()):
                raise Falsehood("a record with values that are not finite was read")

    return use


def use_modes(folder: Path) -> None:
    """Read identified modes, and compare their line with a line of the library."""
    usable = select_usable(read_modes(folder / "modes.json"), "modes.json")
    compare_line(usable, build_catenary(select_cases([CASE])[0].line))


def use_answer(folder: Path) -> None:
    """Parse a line of an external program."""
    try:
        parse_message((folder / "answer.json").read_bytes())
    except AnswerRefused as refusal:
        raise InputError("answer", str(refusal), "Send one message on a line.") from None


def check(results: Results) -> None:
    """Require consistent results, and for a case in `error` a reason that the suite formulated."""
    found = find_discrepancies(results)
    if found and results.verdict in {"pass", "info"}:
        raise Falsehood(f"{results.verdict}: {found[0]}")
    for case in results.cases:
        raised = (case.reason or "").split(":")[0].endswith(("Error", "Exception", "Warning"))
        if case.verdict == "error" and raised and not (case.reason or "").startswith("InputError"):
            raise Falsehood(f"the runner caught {case.reason}")
        if case.verdict == "pass" and any(item.value is None for item in case.criteria):
            raise Falsehood("a criterion without a value passed")
