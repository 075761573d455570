"""Types of results.json and of the other files that the suite writes."""
