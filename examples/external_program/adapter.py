"""Adapter of a program that reads input files and writes output files.

The program of this example is `pantocheck simulate` in a separate process. For your own program, replace the function
`simulate` and the input files. The steps stay the same: write the input files of a case, run the program with a time
limit, and deliver its output files.

Try it:  pantocheck run 'en50318-2002/*' --system 'command:python3 examples/external_program/adapter.py pantocheck'
The argument is the command that starts the program.
"""

import hashlib
import json
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

PROTOCOL = "pantocheck.command/1"
FEATURES = [
    "applied_forces", "base_spring_at_wire_height", "bending_stiffness", "cant", "chain", "curves", "dropper_mass",
    "droppers", "gradients", "irregularity", "listed_spans", "matrices", "messenger_wire_held_along_track",
    "modal_damping", "modes", "point_masses", "presag", "pushing_steady_arms", "rayleigh_damping", "sections",
    "several_pantographs", "single_supports", "stagger", "steady_arm_dampers", "steady_arm_mass", "steady_arms",
    "stitch_wire", "support_dampers", "surveyed_wire_heights", "twin_wires", "uplift_force_tuning", "variation",
    "wire_changes", "wire_springs", "wire_height",
]  # fmt: skip
"""Features that the program takes into account. A case with another one, such as `line_at_rest`, is skipped."""
FORCES = ("uplift_force_N", "target_mean_force_N")


def toml_lines(table, path=()):
    """Lines of TOML of nested tables: plain values first, then tables, then lists of tables. Null is left out."""
    tables = {key: value for key, value in table.items() if isinstance(value, dict)}
    lists = {
        key: value for key, value in table.items() if isinstance(value, list) and value and isinstance(value[0], dict)
    }
    for key, value in table.items():
        if key not in tables and key not in lists and value is not None:
            yield f"{key} = {json.dumps(value)}"
    for key, value in tables.items():
        yield f"[{join_keys(*path, key)}]"
        yield from toml_lines(value, (*path, key))
    for key, values in lists.items():
        for value in values:
            yield f"[[{join_keys(*path, key)}]]"
            yield from toml_lines(value, (*path, key))


def join_keys(*keys):
    """Dotted key of TOML; a name of the user, such as that of a dropper schedule, is quoted."""
    return ".".join(key if key.isidentifier() and key.isascii() else json.dumps(key) for key in keys)


def write_law(applied):
    """Force law of a pantograph with a static and an aerodynamic force, as the program reads it."""
    aerodynamic = {"on": applied["aerodynamic_force_on"], "constant_N": applied["aerodynamic_force_N"]}
    static = applied["static_force_N"]
    return {"kind": "applied_forces", "static_force_N": static, "aerodynamic_force": aerodynamic}


def write_input(case):
    """Write the case, its line and its pantographs as files."""
    Path("line.toml").write_text("\n".join(toml_lines(case["line"])), encoding="utf-8")
    uses = []
    for i, train in enumerate(case["pantographs"], 1):
        parts = {key: train[key] for key in ("chain", "matrices", "modes", "contact") if train[key] is not None}
        model, forces = {"title": f"pantograph {i}", **parts}, {key: train[key] for key in FORCES}
        if (applied := train.get("applied_forces")) is not None:
            model["force_law"], forces = write_law(applied), {"force_from": "law"}
        Path(f"pantograph{i}.toml").write_text("\n".join(toml_lines(model)), encoding="utf-8")
        uses.append({"model": f"pantograph{i}.toml", **forces})
    starts = [train["start_m"] for train in case["pantographs"]]
    content = {
        "id": case["id"],
        "title": case["title"],
        "line": "line.toml",
        "speed_km_h": case["speed_km_h"],
        "evaluated_m": case["evaluated_m"],
        "start_m": starts[-1],
        "run_out_m": case["pantographs"][-1]["end_m"] - case["evaluated_m"][1],
        "spacing_m": [a - b for a, b in pairwise(starts)] or None,
        "filter": case["filter"],
        "discretisation": case["discretisation"],
        "pantograph": uses,
    }
    Path("case.toml").write_text("\n".join(toml_lines(content)), encoding="utf-8")


def simulate(program, time_limit):
    """Run the program. Its output goes to the standard error; if it fails, the report quotes the end."""
    subprocess.run(
        [*program, "simulate", "case.toml", "--out", "record.h5"],
        stdout=sys.stderr, timeout=time_limit, check=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip


def name_case(case):
    """Name the requested case in the sidecar, in place of the case file that the program read."""
    sidecar = Path("record.toml")
    lines = sidecar.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("case_digest = ")]
    sidecar.write_text("\n".join([f'case_digest = "{case["case_digest"]}"', *kept]), encoding="utf-8")


def describe_file(name):
    """Name and SHA-256 of a file."""
    return {"file": name, "sha256": hashlib.sha256(Path(name).read_bytes()).hexdigest()}


def main(program):
    """Answer messages until `stop` or the end of the input."""
    for line in sys.stdin:
        message = json.loads(line)
        if message["message"] == "stop":
            break
        if message["message"] == "start":
            version = subprocess.run([*program, "--version"], capture_output=True, text=True, check=True).stdout
            name, _, version = version.strip().rpartition(" ")
            answer = {"message": "started", "protocol": PROTOCOL, "name": f"{name} (external)", "version": version}
            answer["features"] = FEATURES
        elif missing := sorted(set(message["case"]["features"]) - set(FEATURES)):
            reason = f"the program neglects {', '.join(missing)}"
            answer = {"message": "skipped", "id": message["id"], "reason": reason}
        else:
            write_input(message["case"])
            try:
                simulate(program, 0.9 * message["time_limit_s"])
                name_case(message["case"])
                record = {"sidecar": describe_file("record.toml"), "table": describe_file("record.h5")}
                answer = {"message": "delivered", "id": message["id"], "record": record}
            except (OSError, subprocess.SubprocessError) as error:
                answer = {"message": "errored", "id": message["id"], "reason": str(error)}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    if not sys.argv[1:]:
        sys.exit("usage: adapter.py PROGRAM [ARGUMENT ...], for example adapter.py pantocheck")
    main(sys.argv[1:])
