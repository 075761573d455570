"""Run of a rig: line of a case, limits that its passage needs, and the files of a run."""

import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.files import write_atomically
from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.line.catenary_model import discretise_line
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.runs.case_run import build_passage, record_passage
from pantocheck.conformance.runs.core_requirement import require_core
from pantocheck.conformance.runs.rig_control import RigControl, RigLimits
from pantocheck.conformance.runs.rig_link import RigLink
from pantocheck.conformance.runs.rig_loop import RigLog, RigTimes, SystemClock, convert_log, prefer_loop, run_loop
from pantocheck.conformance.runs.uplift_tuning import estimate_uplift_forces
from pantocheck.model.description.failures import ImpossiblePassage
from pantocheck.model.dynamics.stepped_passage import SteppedPassage

TIME_QUANTILES = {"median_us": 0.5, "99.99_pct_us": 0.9999}
"""Quantiles of the times of a run by their names in its summary."""


def build_stepped_passage(case: Case, time_step: float) -> SteppedPassage:
    """Passage of a case in steps [s].

    Raises:
        InputError: The case has not one linear pantograph with one strip, or there is no core in C.
    """
    require_core("system rig")
    discretisation = case.file.discretisation.model_copy(update={"time_step_s": time_step})
    line = discretise_line(case.line, discretisation.element_m)
    passage = build_passage(case, line, discretisation, estimate_uplift_forces(case, line))
    try:
        return SteppedPassage(line, passage)
    except ImpossiblePassage as error:
        raise InputError(f"case '{case.id}'", f"{error}", "Choose another case, or install the suite again.") from None


def check_limits(line: SteppedPassage, limits: RigLimits) -> None:
    """Check that the linear model alone stays within the limits, before a rig moves.

    Raises:
        InputError: It does not.
    """
    line.restart()
    states = np.abs([line.advance(0.0) for _ in range(line.steps)]).max(axis=0)
    line.restart()
    for name, limit, needed, unit, factor in zip(
        ("travel", "speed", "force"), (limits.travel, limits.speed, limits.force), states, ("mm", "m/s", "N"),
        (1e3, 1.0, 1.0), strict=True,
    ):  # fmt: skip
        if needed > limit:
            found = f"is {factor * limit:g} {unit}; the passage of the linear model needs {factor * needed:.3g} {unit}"
            raise InputError(f"limit of the {name}", found, "Raise the limit if the rig allows it, or slow the train.")


def run_rig(case: Case, control: RigControl, link: RigLink, out: Path) -> dict[str, Any]:
    """Run a rig, and write `rig.json`, `log.npy` and, after a complete passage, the record of the last one.

    Args:
        case: Case of the line.
        control: Control at its start.
        link: Exchange with the rig.
        out: Folder.

    Returns:
        Summary, as in `rig.json`.
    """
    out.mkdir(parents=True, exist_ok=True)
    passages = control.left
    with tempfile.TemporaryDirectory(dir=out) as folder:
        rows = Path(folder) / "rows"
        with rows.open("wb", buffering=0) as file, prefer_loop() as preferred:
            times = run_loop(control, link, SystemClock(), RigLog(file))
        convert_log(rows, out / "log.npy")
    summary = {
        "case": case.id,
        "case_digest": case.digest,
        "stopped": control.reason or None,
        "passages": passages - control.left,
        "limits": control.limits._asdict(),
        "cutoff_Hz": control.cutoff,
        "step_s": control.dt,
        "real_time_priority": preferred,
        "samples": control.samples,
        "refused_messages": control.refused,
        **describe_times(times),
    }
    write_atomically(out / "rig.json", (json.dumps(summary, indent=2) + "\n").encode())
    if control.line.step == control.line.steps:
        passage = control.line.passage
        write_record(
            out / "record.csv",
            record_passage(case, passage, control.line.build_history()),
            case=case.id,
            system={"name": "line and rig", "version": case.digest[:12]},
            further={"case_digest": case.digest, "line": {"span_m": case.line.geometry.longest_span}},
        )
    return summary


def describe_times(times: RigTimes) -> dict[str, Any]:
    """Steps, misses and quantiles of the times of a run."""
    parts = {"work": times.work, "lateness": times.lateness, "delay": times.delay}
    return {
        "steps": times.steps,
        "missed_deadlines": times.missed,
        **{
            name: {key: part.quantile_us(share) for key, share in TIME_QUANTILES.items()}
            | {"worst_us": round(1e6 * part.worst_s, 1)}
            for name, part in parts.items()
        },
    }
