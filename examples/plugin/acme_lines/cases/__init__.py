"""Case files of the package."""
