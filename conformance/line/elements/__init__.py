"""Elements of a line, one declaration each."""
