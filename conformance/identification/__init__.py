"""Catenary damping from mass-drop records: poles, their uncertainty, and the damping model fitted to them."""
