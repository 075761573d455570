"""Numbers and tables of the documentation."""
