"""Second formulations of the same equations: finite differences and geometrically exact points."""
