"""Measured records: sampled by time or distance, with gaps and changes of speed, filtered by the measuring chain.

The usable parts of a record are selected and every cut is reported. Their length decides the uncertainty of the
statistics. A simulated record passes through unchanged.
"""
