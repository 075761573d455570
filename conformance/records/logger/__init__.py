"""Records of data loggers: columns with other names and units, sums of force sensors, positions and events."""
