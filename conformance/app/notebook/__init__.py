"""Python interface for scripts and notebooks."""
