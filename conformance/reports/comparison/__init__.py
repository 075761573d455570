"""Reports on comparisons of measured values with a model."""
