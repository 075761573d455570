"""Collections of runs: many records of railway lines, and their assessment by sections."""
