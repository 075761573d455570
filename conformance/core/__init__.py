"""Common ground of all subjects: errors, files, tables, units, trust, limits, criteria, verdicts and figures."""
