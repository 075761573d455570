"""Studies that run a case several times."""
