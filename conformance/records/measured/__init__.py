"""Measured records: sampled by distance, with gaps and changes of speed, filtered when recorded, of some length.

What the line sees is cut out of what was recorded, each cut is said, and the length of what is left decides how far
its statistics can be trusted. A simulated record goes through the same and comes out as it went in.
"""
