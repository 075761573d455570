"""The reference simulator: mechanics only; knows no standard, no file format, no report."""
