"""Static site of results: systems against cases, and versions over time."""
