"""Statistics of a record: each quantity is a definition, its unit, its source and what it needs."""
