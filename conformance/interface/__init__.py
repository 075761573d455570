"""Python interface: cases, runs, graded results and mass drops for scripts and notebooks."""
