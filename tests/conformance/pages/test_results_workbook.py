"""results.xlsx: the numbers of results.json, each with its unit."""
