"""From measured frequency responses of a pantograph head to a chain of lumped masses."""
