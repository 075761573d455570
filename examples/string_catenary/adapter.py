"""Adapter of `simulator.py`: the complete protocol of Pantocheck, with the standard library of Python only.

Try it:  pantocheck run 'en50318-2002/*' --system 'command:python3 examples/string_catenary/adapter.py'
"""

import hashlib
import json
import sys
import time

PROTOCOL = "pantocheck.command/2"
NAME, VERSION = "string catenary", "1.0"


def reason_to_skip(case):
    """Reason why the simulator does not support a case; None if it does. A skipped case does not count as a failure."""
    line, derived, trains = case["line"], case["derived"]["line"], case["pantographs"]
    if case["speed_km_h"] is None:
        return "checks of the line at rest are not supported"
    if len(trains) != 1:
        return "only one pantograph is supported"
    if trains[0]["uplift_force_N"] is None or trains[0]["target_mean_force_N"] is not None:
        return "tuning of the uplift force is not supported"
    if trains[0]["chain"] is None:
        return "only pantographs with a chain of masses are supported"
    if trains[0]["chain"]["base_spring_unstretched"] != "working_height":
        return "only a base spring that is unstretched at the working height is supported"
    if line["stitch_wire"] or line["contact_wire"]["number"] > 1 or line["damping"]["modal"]:
        return "stitch wires, twin contact wires and modal damping are not supported"
    if derived["contact_wire"]["lateral_position_m"] is not None:
        return "stagger is not supported: only the vertical plane is simulated"
    if derived["steady_arms"]["vertical_damper_N_s_m"] != 0:
        return "dampers of steady arms are not supported"
    if derived["messenger_supports"]["held_along_track"] is not False:
        return "messenger wires that are held along the track are not supported"
    wires = (derived["contact_wire"], derived["messenger_wire"])
    if any(wire.get("stretches") or wire.get("irregularity") for wire in wires) or derived.get("point_masses"):
        return "changes of a wire, its irregularity and point masses are not supported"
    return None


def run(case):
    """Simulate a case, write its record into the working folder, and build the answer without its id."""
    import simulator

    start = time.perf_counter()
    supports, history = simulator.simulate(case)
    wall = time.perf_counter() - start
    names = ["time_s", "position_1_m", "force_1_N", "contact_height_1_m"]
    names += [f"uplift_{i + 1}_m" for i in range(len(supports))]
    with open("record.csv", "w") as table:
        print(",".join(names), file=table)
        for sample in history:
            print(",".join(f"{value:.9g}" for value in sample), file=table)
    sidecar = {
        "schema": "pantocheck.record/1",
        "case": case["id"],
        "file": "record.csv",
        "speed_km_h": case["speed_km_h"],
        "pantographs": 1,
        "evaluated_m": case["evaluated_m"],
        "filter_applied_Hz": "none",
        "support_position_m": list(map(float, supports)),
    }
    with open("record.toml", "w") as file:
        for key, value in sidecar.items():
            print(key, "=", json.dumps(value), file=file)  # these values look the same in JSON and TOML
        print(f"[system]\nname = {json.dumps(NAME)}\nversion = {json.dumps(VERSION)}", file=file)
        # The line starts in equilibrium under the uplift force, and the train at full speed.
        print(f"[start]\nplace_m = {case['pantographs'][-1]['start_m']}\nramp_m = 0.0", file=file)
        print('state = "equilibrium_under_uplift_forces"', file=file)
        print(f"[run]\nwall_s = {wall:.3f}\nsimulated_s = {history[-1, 0]:.9g}", file=file)
        print(f"dt_s = {case['discretisation']['time_step_s']}", file=file)
        print(f"element_m = {case['discretisation']['element_m']}", file=file)
    record = {"sidecar": describe_file("record.toml"), "table": describe_file("record.csv")}
    return {"message": "delivered", "record": record, "notes": ["Finite differences, explicit time stepping."]}


def describe_file(name):
    """Name and SHA-256 of a file."""
    with open(name, "rb") as file:
        return {"file": name, "sha256": hashlib.sha256(file.read()).hexdigest()}


def main():
    """Answer messages until `stop` or the end of the input."""
    answers = sys.stdout
    sys.stdout = sys.stderr  # output of libraries must not mix with the answers
    for line in sys.stdin:
        message = json.loads(line)
        if message["message"] == "stop":
            break
        if message["message"] == "start":
            answer = {"message": "started", "protocol": PROTOCOL, "name": NAME, "version": VERSION}
        elif (reason := reason_to_skip(message["case"])) is not None:
            answer = {"message": "skipped", "id": message["id"], "reason": reason}
        else:
            try:
                answer = run(message["case"]) | {"id": message["id"]}
            except (ArithmeticError, ValueError) as error:
                answer = {"message": "errored", "id": message["id"], "reason": str(error) or type(error).__name__}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
