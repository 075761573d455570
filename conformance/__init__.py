"""Cases, quantities, verdicts, systems under test, identification, reports, command line, pytest plugin."""
