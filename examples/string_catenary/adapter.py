"""Adapter of `simulator.py`, with the kit `pantocheck_adapter.py`, which answers the messages and writes the record.

Try it:  pantocheck run 'en50318-2002/*' --system 'command:python3 examples/string_catenary/adapter.py'
"""

from pantocheck_adapter import START_OF_THE_CASE, Record, Skip, serve


def reason_to_skip(case):
    """Reason why the simulator does not support a case; None if it does. The verdict is then `skip`, not `fail`."""
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


def simulate(case):
    """Simulate a case; the simulator starts from equilibrium under the uplift force, with the train at full speed."""
    import simulator

    reason = reason_to_skip(case)
    if reason is not None:
        raise Skip(reason)
    supports, history = simulator.simulate(case)
    time, position, force, height, *uplift = history.T
    return Record(
        time_s=time,
        position_m=[position],
        force_N=[force],
        start=START_OF_THE_CASE,
        contact_height_m=[height],
        support_position_m=supports,
        uplift_m=uplift,
        run={"dt_s": case["discretisation"]["time_step_s"], "element_m": case["discretisation"]["element_m"]},
        notes=["Finite differences, explicit time stepping."],
    )


if __name__ == "__main__":
    serve("string catenary", "1.0", simulate)
