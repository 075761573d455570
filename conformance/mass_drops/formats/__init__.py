"""One reader per file format of mass-drop records."""
