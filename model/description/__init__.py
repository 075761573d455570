"""Description of lines and pantographs as values."""
