"""Readers of measured tables, one module per file format, and writers of CSV and HDF5."""
