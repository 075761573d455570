"""Formats of measured tables: the format follows from the suffix, and messages list the formats of the table."""

from pathlib import Path

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.measured_table import CSV, HDF5, TABLE_FORMATS, find_table_format, list_suffixes


def test_formats_follow_from_unique_suffixes_and_are_listed() -> None:
    assert list_suffixes(TABLE_FORMATS) == ".csv, .uff, .mat, .h5, .tdms, .mf4, .parquet, .xlsx or .ods"
    assert list_suffixes((CSV,)) == ".csv"
    with pytest.raises(InputError, match=r"has the unknown suffix '\.xls'\.\n  Known formats are \.csv or \.h5\."):
        find_table_format(Path("a.xls"), (CSV, HDF5))
    with pytest.raises(
        InputError, match=r"has no suffix\.\n  Did you mean 250\.csv \? Known formats are \.csv or \.h5\."
    ):
        find_table_format(Path("records/250"), (CSV, HDF5))
    suffixes = [suffix for table_format in TABLE_FORMATS for suffix in table_format.suffixes]
    assert sorted(set(suffixes)) == sorted(suffixes)
    assert all(suffix == suffix.lower() for suffix in suffixes)
    assert find_table_format(Path("A.HDF5"), (CSV, HDF5)) is HDF5
