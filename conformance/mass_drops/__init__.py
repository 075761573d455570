"""Records of mass drops: read and written in the formats of measuring systems."""
