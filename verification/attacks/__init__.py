"""Attacks on documents, records, readers and tests: forgeries, manipulations, damaged files and mutants."""
