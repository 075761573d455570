"""Case files: what is simulated or measured, what is evaluated, and the limits, each number with its source."""
