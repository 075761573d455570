"""Adapter of `simulator.py`, with the kit `pantocheck_adapter.py`, which answers the messages and writes the record.

Try it:  pantocheck run 'en50318-2002/*' --system 'command:python3 examples/string_catenary/adapter.py'
"""

from pantocheck_adapter import START_OF_THE_CASE, Record, serve

FEATURES = (
    "applied_forces",
    "bending_stiffness",
    "chain",
    "dropper_mass",
    "droppers",
    "gradients",
    "listed_spans",
    "presag",
    "rayleigh_damping",
    "single_supports",
    "steady_arm_mass",
    "steady_arms",
    "support_dampers",
    "surveyed_wire_heights",
    "wire_height",
)
"""Features that the simulator takes into account; a case with another one is skipped."""


def simulate(case):
    """Simulate a case; the simulator starts from equilibrium under the uplift force, with the train at full speed."""
    import simulator

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
    serve("string catenary", "1.0", simulate, FEATURES)
