"""Kit for adapters in Python: messages, record files and digests. Copy this file beside your adapter.

It needs the standard library only. An adapter is a function that simulates a case, and one call:

    from pantocheck_adapter import Record, Skip, serve

    def simulate(case):
        ...
        return Record(time_s=..., position_m=[...], force_N=[...], start=START_OF_THE_CASE)

    serve("my simulator", "1.0", simulate, features=["chain", "droppers", "stagger", "steady_arms"])

`features` lists what your simulator takes into account, by the names in docs/systems.md. A case that uses another
feature is skipped before `simulate` is called.

Try it:  pantocheck system check 'python3 adapter.py'
"""

import hashlib
import json
import os
import sys
import time
import traceback
from dataclasses import dataclass, field

PROTOCOL = "pantocheck.command/1"

START_OF_THE_CASE = "as in the case"
"""The line starts at rest under the uplift forces, and the train at full speed, at the place of the case."""


class Skip(Exception):
    """The simulator does not support a case: verdict `skip`, not `fail`. The exit code of the run is 1."""


@dataclass
class Record:
    """Result of a simulation: evenly spaced samples in SI units, one list per pantograph or support.

    Leave out a channel that the simulator does not compute: criteria that need it are skipped.
    """

    time_s: list
    """Times [s]."""
    position_m: list
    """Position of each pantograph along the track [m]."""
    force_N: list
    """Contact force of each pantograph, unfiltered [N]."""
    start: object
    """`START_OF_THE_CASE`, or the values of [start] in the sidecar: place_m, ramp_m and state."""
    contact_height_m: list = ()
    """Height of the contact wire at each pantograph [m]."""
    support_position_m: list = ()
    """Positions of the supports whose uplift is recorded [m]."""
    uplift_m: list = ()
    """Uplift of the contact wire at each support [m]."""
    run: dict = field(default_factory=dict)
    """Facts on the run: dt_s, element_m."""
    notes: list = ()
    """Notes for the reader of the report."""
    filter_applied_Hz: object = "none"
    """Cut-off of a low-pass filter that was applied to the force [Hz], or "none"."""


def serve(name, version, simulate, features):
    """Answer the messages of Pantocheck until it says stop.

    `simulate` receives a case as a dictionary and returns a `Record`, or a dictionary of static quantities for a check
    of the line at rest (`speed_km_h` is None). It is not called for a case that uses a feature which is not in the list
    `features`. It raises `Skip` for any other case that is not supported. Any other exception
    becomes the verdict `error` of the case, and its traceback goes to the log. Printed output goes to the log, too.
    """
    # Output of libraries, even of compiled ones, must not mix with the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        message = json.loads(line)
        if message["message"] == "stop":
            break
        if message["message"] == "start":
            answer = {"message": "started", "protocol": PROTOCOL, "name": name, "version": version}
            answer["features"] = sorted(features)
        else:
            answer = {"id": message["id"]} | _run(name, version, simulate, features, message["case"])
        print(json.dumps(answer), file=answers, flush=True)


def _run(name, version, simulate, features, case):
    """Answer to a message `run`, without its number."""
    begin = time.perf_counter()
    try:
        missing = sorted(set(case["features"]) - set(features))
        if missing:
            raise Skip(f"the simulator neglects {', '.join(missing)}")
        result = simulate(case)
        if isinstance(result, dict):
            return {"message": "delivered", "static": result}
        facts = {"wall_s": round(time.perf_counter() - begin, 3), "simulated_s": float(result.time_s[-1])}
        files = write_record(result, case, {"name": name, "version": version}, facts | result.run)
        return {"message": "delivered", "record": files, "notes": list(result.notes)}
    except Skip as reason:
        return {"message": "skipped", "reason": str(reason)}
    except Exception as error:
        traceback.print_exc()
        return {"message": "errored", "reason": f"{type(error).__name__}: {error}"[:1500] + _list_places(error)}


def _list_places(error):
    """Files and lines from the adapter to the place that raised an error, as text behind its reason."""
    frames = traceback.extract_tb(error.__traceback__)[1:]  # the first one is this file
    places = [f"{os.path.basename(frame.filename)}, line {frame.lineno}" for frame in frames]
    return f" ({'; '.join(places[-4:])})" if places else ""


def write_record(record, case, system, run):
    """Write table and sidecar into the working folder; names of the files with their digests."""
    columns = {"time_s": record.time_s}
    for key in ("position", "force", "contact_height", "uplift"):
        unit = "N" if key == "force" else "m"
        for number, values in enumerate(getattr(record, f"{key}_{unit}"), 1):
            columns[f"{key}_{number}_{unit}"] = values
    with open("record.csv", "w", encoding="utf-8", newline="\n") as table:
        print(",".join(columns), file=table)
        for sample in zip(*columns.values(), strict=True):
            print(",".join(f"{value:.9g}" for value in sample), file=table)
    start = record.start
    if start == START_OF_THE_CASE:
        place = case["pantographs"][-1]["start_m"]
        start = {"place_m": place, "ramp_m": 0.0, "state": "equilibrium_under_uplift_forces"}
    sidecar = {
        "schema": "pantocheck.record/1",
        "case": case["id"],
        "case_digest": case["case_digest"],
        "file": "record.csv",
        "speed_km_h": case["speed_km_h"],
        "pantographs": len(record.force_N),
        "evaluated_m": case["evaluated_m"],
        "filter_applied_Hz": record.filter_applied_Hz,
    }
    if len(record.support_position_m):
        sidecar["support_position_m"] = [float(position) for position in record.support_position_m]
    with open("record.toml", "w", encoding="utf-8", newline="\n") as file:
        for heading, table in ((None, sidecar), ("system", system), ("start", start), ("run", run)):
            if heading is not None:
                print(f"[{heading}]", file=file)
            for key, value in table.items():
                print(key, "=", json.dumps(value), file=file)  # these values look the same in JSON and TOML
    return {"sidecar": describe_file("record.toml"), "table": describe_file("record.csv")}


def describe_file(name):
    """Name and SHA-256 of a file."""
    with open(name, "rb") as file:
        return {"file": name, "sha256": hashlib.sha256(file.read()).hexdigest()}
