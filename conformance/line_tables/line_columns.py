"""Columns of the tables of supports and droppers: the keys of a line file, those of inner tables behind their name."""

from pantocheck.conformance.cases.dropper_schedule import DropperSchedule
from pantocheck.conformance.cases.support_tables import MessengerSupportChanges, SteadyArmChanges, SupportTable
from pantocheck.conformance.input_files.sourced_table import InputTable

INNER_TABLES: dict[str, type[InputTable]] = {
    "steady_arm": SteadyArmChanges,
    "messenger_support": MessengerSupportChanges,
}
"""Tables inside the table of a support."""

SUPPORT_KEYS: dict[str, tuple[str, ...]] = {
    **{key: (key,) for key in SupportTable.model_fields if key != "number" and key not in INNER_TABLES},
    **{f"{table}_{key}": (table, key) for table, model in INNER_TABLES.items() for key in model.model_fields},
}
"""Path inside the table of a support, by the name of a column: `steady_arm_length_m` is `steady_arm.length_m`."""

POSITION, SPAN_LENGTH = "x_m", "span_m"

SUPPORT_COLUMNS = ("number", "name", POSITION, SPAN_LENGTH, *SUPPORT_KEYS)
"""Columns of the table of supports."""

DROPPER_KEYS = tuple(DropperSchedule.model_fields)
"""Columns of the table of droppers that are keys of a schedule."""

DROPPER_COLUMNS = ("span", *DROPPER_KEYS)
"""Columns of the table of droppers."""
