"""Contents and lowest versions of the packages."""
