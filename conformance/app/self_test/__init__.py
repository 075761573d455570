"""Test of the suite by systems with known faults."""
