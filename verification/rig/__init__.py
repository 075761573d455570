"""Evidence about the line under a rig: a simulated rig, and measurements with it."""
