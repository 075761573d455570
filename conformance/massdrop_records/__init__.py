"""Records of mass drops: read and written in the formats of measuring systems."""

from pantocheck.conformance.massdrop_records.reading import read_records
from pantocheck.conformance.massdrop_records.record import Channel, Drop, DropRecord, Line
from pantocheck.conformance.massdrop_records.writing import write_csv, write_hdf5, write_uff

__all__ = ["Channel", "Drop", "DropRecord", "Line", "read_records", "write_csv", "write_hdf5", "write_uff"]
