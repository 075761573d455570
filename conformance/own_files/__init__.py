"""Files of a user: check of existing files, and templates of new ones."""
