"""Systems under test: the reference simulator, a folder of records, a command."""
