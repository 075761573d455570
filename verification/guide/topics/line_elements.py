"""Topic: elements of a line, contact laws and laws of the head in a short passage, against finite differences."""

from dataclasses import replace
from pathlib import Path

from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.core.toml_file import read_model
from pantocheck.conformance.pantograph.pantograph_file import ContactTable, PantographFile
from pantocheck.conformance.runs.command_system import build_case_message
from verification.formulations import finite_differences
from verification.formulations.difference_passage import Quantities, difference_quantities
from verification.formulations.finite_differences import find_case, reference_quantities
from verification.formulations.point_convergence import shorten
from verification.guide.comparisons import compare_relative
from verification.guide.guide_format import Topic

SIMPLE, STITCHED = "en50318-2018/ac-simple/320", "en50318-2018/ac-stitched/320"
LINES = {
    "Wires": SIMPLE,
    "StitchWires": STITCHED,
    "Droppers": f"{SIMPLE}+droppers",
    "SteadyArms": f"{SIMPLE}+arms",
    "MessengerSupports": f"{SIMPLE}+supports",
    "LineDamping": f"{SIMPLE}+damping",
    "Irregularities": f"{SIMPLE}+irregular",
    "PointMasses": f"{SIMPLE}+masses",
    "WireSprings": f"{SIMPLE}+springs",
    "TrackCurves": f"{SIMPLE}+curved",
    "Variations": f"{SIMPLE}+varied",
}
"""Case of every element, with the change of its line that brings it out."""

OTHERS = {
    "TensionSections": "the overlaps have a benchmark of their own",
    "Tolerances": "they are no part of a passage",
}
"""Elements without a row."""

CONTACTS = {
    "spring with a damper": ContactTable(stiffness_N_m=50e3, damping_N_s_m=50.0),
    "law of Hertz": ContactTable(law="hertz", effective_modulus_N_m2=1e8, effective_radius_m=0.02),
    "constraint": ContactTable(law="constraint"),
}
"""Contacts beside the spring of the case. That of Hertz is softer than the points: others are near a constraint."""

HEADS = {
    "two strips": "two_strips",
    "friction and stops": "rubbing_head",
    "roll, bending and friction": "rolling_head",
}
"""Pantograph file of every structure of the head."""

SPANS = 5
UPLIFT_N = 169.0
SPACINGS, MESH = (0.25, 0.125), (0.25, 5e-4)
"""Distances of the points [m]; element length [m] and time step [s]."""

QUANTITIES = {"std_force_N": ("standard deviation, 0-20 Hz", 0.0025), "rms_20_50_N": ("RMS, 20-50 Hz", 0.0075)}
"""Compared quantities, and their tolerances: the largest measured differences and a half."""

DAMPED = 0.025
"""Tolerance of the upper band with a damper, which the points approach with order 1."""


def study_line_elements() -> Topic:
    """Short passages with every element, every contact law and every law of the head."""
    plain = shorten(find_case(SIMPLE), SPANS)
    cases = {name: shorten(find_case(id_), SPANS) for name, id_ in LINES.items()}
    for name, contact in CONTACTS.items():
        cases[name] = replace(plain, pantographs=(plain.pantographs[0].model_copy(update={"contact": contact}),))
    cases |= {name: replace(plain, pantographs=(read_head(file),)) for name, file in HEADS.items()}
    pairs = {name: (reference_quantities(case, *MESH, (UPLIFT_N,)), extrapolate(case)) for name, case in cases.items()}
    return Topic(
        title="Elements of a line, contact laws and heads",
        theory="Explicit finite differences solve the same equations with points in place of elements, and share no "
        "code with the reference simulator. A change of the line brings out each element.",
        setting=f"Spans 2 and 3 of {SPANS}, 320 km/h, {UPLIFT_N:g} N; points {SPACINGS[0]:g} m and {SPACINGS[1]:g} m "
        f"apart, extrapolated with order 2; elements of {MESH[0]:g} m. "
        f"Without a row: {'; '.join(map(': '.join, OTHERS.items()))}.",
        comparisons=[
            compare_relative(
                f"{name.replace(',', '').replace(' ', '-')}-{quantity}",
                f"{name}: {words}",
                "N",
                (ours[1, quantity], other[1, quantity]),
                DAMPED if "damper" in name and quantity == "rms_20_50_N" else tolerance,
                "Largest measured difference and a half.",
            )
            for name, (ours, other) in pairs.items()
            for quantity, (words, tolerance) in QUANTITIES.items()
        ],
    )


def read_head(name: str) -> PantographFile:
    """Pantograph of the comparison of formulations, by the name of its file."""
    return read_model(Path(finite_differences.__file__).with_name(f"{name}.toml"), PantographFile, "pantograph")


def extrapolate(case: Case) -> Quantities:
    """Quantities of a case in the second formulation, by Richardson extrapolation of order 2."""
    coarse, fine = (difference_quantities(build_case_message(case), h, (UPLIFT_N,)) for h in SPACINGS)
    return {key: value + (value - coarse[key]) / 3 for key, value in fine.items()}
