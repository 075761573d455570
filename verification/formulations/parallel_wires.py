"""Line whose parallel wires are merged into one with the sums of their properties, for formulations of single wires.

Parallel wires with equal droppers and arms move alike if the line stays in the vertical plane: the merged line then has
the same motion. A head touches every contact wire through a spring of its own, so their springs add up as well.
"""

from dataclasses import replace

from pydantic import BaseModel

from pantocheck.conformance.cases.case import Case


def merge_parallel_wires(case: Case) -> Case:
    """Case on the merged line; the case itself on a line of single wires.

    Raises:
        ValueError: The line leaves the vertical plane, or contact is no spring.
    """
    line = case.line
    contacts, messengers = line.contact_wire.number, line.messenger_wire.number
    if contacts == 1:
        return case
    if line.layout.has_stagger or any(file.contact.stiffness_N_m is None for file in case.pantographs):
        raise ValueError("parallel wires can be merged in the vertical plane and with contact springs only")
    wire = ("tension_N", "mass_kg_m", "bending_stiffness_N_m2")
    dropper = ("stiffness_N_m", "mass_kg", "clamp_on_messenger_kg", "clamp_on_contact_kg")
    single = {"number": 1, "spacing_m": None}
    tables = {
        "contact_wire": _scale(line.contact_wire, contacts, wire).model_copy(update=single),
        "messenger_wire": _scale(line.messenger_wire, messengers, wire).model_copy(update=single),
        "droppers": _scale(line.droppers, contacts, dropper),
        "steady_arm": _scale(line.steady_arm, contacts, ("vertical_stiffness_N_m", "clamp_kg")),
        "messenger_support": _scale(line.messenger_support, messengers, ("stiffness_N_m", "damping_N_s_m")),
    }
    files = tuple(
        file.model_copy(update={"contact": _scale(file.contact, contacts, ("stiffness_N_m",))})
        for file in case.pantographs
    )
    return replace(case, line=line.model_copy(update=tables), pantographs=files)


def _scale(table: BaseModel, factor: int, keys: tuple[str, ...]) -> BaseModel:
    """Table with some of its values times a factor; those that it does not state stay so."""
    values = {key: getattr(table, key) for key in keys}
    return table.model_copy(update={key: factor * value for key, value in values.items() if value is not None})
