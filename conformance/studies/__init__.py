"""Studies: cases that need several runs, or mass drops and their identification."""
