"""Measured records, sampled by time or distance, with gaps, changes of speed and filters of the measuring chain.

The usable part that covers the analysis section is selected, and every cut is reported. Its length decides the
uncertainty of the statistics. A simulated record passes through unchanged.
"""
