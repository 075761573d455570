"""Systems under test: the reference simulator, a record on disk, a command."""
