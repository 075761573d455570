"""From identified modes to a damping model."""
