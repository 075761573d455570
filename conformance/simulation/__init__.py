"""Translation of a case for the reference simulator: catenary, passage, static quantities, tuning, mass drops."""
