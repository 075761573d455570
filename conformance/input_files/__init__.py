"""Files that users give to the suite: bounded reading, validation, units, tables of measured data, input errors."""
