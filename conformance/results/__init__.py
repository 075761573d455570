"""results.json: format, building, reading, traces."""
