"""Damping of a line from mass-drop records: poles with uncertainty, and a damping model fitted to the modes."""
