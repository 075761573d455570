"""Contact-force records: a table of samples (CSV or HDF5) and a TOML sidecar of the same name that describes it.

Format `pantocheck.record/1`; pantographs are numbered from 1 in running order. docs/records.md shows it by example.

============================  ==========================  ==========================================================
CSV column                    HDF5 dataset                meaning
============================  ==========================  ==========================================================
``force_1_N`` ...             ``force_N`` (p, n)          contact force
``time_s``                    ``time_s`` (n)              time, or
``position_1_m`` ...          ``position_m`` (p, n)       contact point along the track; at least one of the two
``speed_m_s``                 ``speed_m_s`` (n)           speed of the train, where it is not constant; may be missing
``contact_height_1_m`` ...    ``contact_height_m`` (p, n) height of the contact point; may be missing
``uplift_1_m`` ...            ``uplift_m`` (s, n)         uplift at the supports that the sidecar lists; may be missing
============================  ==========================  ==========================================================

The unit stands at the end of the name: ``force_1_kN`` and ``speed_km_h`` are converted. A CSV file begins with
one line of column names; columns are separated by commas and decimals by points, or columns by semicolons and
decimals by commas; ``nan`` is a missing value. The keys of the sidecar are those of `RecordSidecar`; it must state
whether the force was filtered (``filter_applied_Hz``: a number or "none").
"""
