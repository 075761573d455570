"""Mass drops: records, identification, damping and simulation."""
