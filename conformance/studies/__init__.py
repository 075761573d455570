"""Studies: mass drops with their identification, and comparisons of several runs."""
