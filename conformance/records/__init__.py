"""Contact-force records: samples, sidecars, logger files and measured records."""
