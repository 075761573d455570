"""From a case to the reference simulator: catenary, passage, static quantities, tuning, mass drops."""
