"""Values against limits: coverage, uncertainty, criteria and verdicts."""
