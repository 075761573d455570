"""Studies of Vo Van, Balmes and Lorang (2015), "Damping characterization of a high speed train catenary"."""
