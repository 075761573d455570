"""Reading a stranger's file: errors, TOML, units, suggestions; writing without leaving half a file."""
