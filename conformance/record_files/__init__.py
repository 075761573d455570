"""Records on disk: a table of samples (CSV or HDF5) and a TOML sidecar of the same name that says what it is.

Format `pantocheck.record/1`. SI units throughout, one sampling rate, pantographs numbered from 1 in running order.

============================  ==========================  ==========================================================
CSV column                    HDF5 dataset                meaning
============================  ==========================  ==========================================================
``time_s``                    ``time_s`` (n)              evenly spaced
``position_1_m`` ...          ``position_m`` (p, n)       contact point along the track
``force_1_N`` ...             ``force_N`` (p, n)          contact force
``contact_height_1_m`` ...    ``contact_height_m`` (p, n) height of the contact point; may be missing
``uplift_1_m`` ...            ``uplift_m`` (s, n)         uplift at the supports that the sidecar lists; may be missing
============================  ==========================  ==========================================================

A CSV file begins with one line of column names; columns are separated by commas, decimals by points. The sidecar's keys
are those of `Sidecar`; it must say whether the force was filtered before (``filter_applied_Hz``: a number or "none").
"""

from pantocheck.conformance.record_files.reading import read_record
from pantocheck.conformance.record_files.sidecar import Sidecar
from pantocheck.conformance.record_files.writing import write_record

__all__ = ["Sidecar", "read_record", "write_record"]
