"""Static states of a line: initial state, lateral state, static solver, elasticity."""
