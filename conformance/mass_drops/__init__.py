"""Mass-drop records: reading and writing in the formats of measuring systems."""
