"""Reports on identification and on fitted damping."""
