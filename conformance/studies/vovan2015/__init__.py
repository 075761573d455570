"""The studies of Vo Van, Balmes and Lorang (2015)."""
