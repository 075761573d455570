"""Test of the suite itself: systems with known faults must not pass, and the reference simulator must."""
