"""Content of a certificate."""
