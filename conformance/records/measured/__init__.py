"""Measured records: sampled by time or distance, with gaps and changes of speed, filtered by the measuring chain.

The usable part that covers the analysis section is selected, and every cut is reported. Its length decides the
uncertainty of the statistics. A simulated record passes through unchanged.
"""
