"""Pages and machine-readable summaries made from results.json alone."""
