"""Elements of a line, one file each: keys, checks, model, derived values, drawing and feature."""
