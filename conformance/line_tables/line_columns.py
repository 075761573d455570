"""Columns of the tables of supports and droppers: the keys of a line file, those of inner tables behind their name."""

from pydantic import BaseModel

from pantocheck.conformance.input_files.table_models import find_model
from pantocheck.conformance.line.elements.dropper import DropperSchedule
from pantocheck.conformance.line.support_table import SupportTable

INNER_TABLES: dict[str, type[BaseModel]] = {
    key: model
    for key, field in SupportTable.model_fields.items()
    if (model := find_model(field.annotation, set())[0]) is not None
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
