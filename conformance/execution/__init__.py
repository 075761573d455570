"""Plans and their execution: cases of a run, on a system, in sequence or in parallel."""
