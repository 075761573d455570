"""Writers of the report formats."""
