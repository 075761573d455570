"""Pages of all reports, made from the types of the results alone."""
