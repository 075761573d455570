"""Speed of the simulator and of whole commands."""
