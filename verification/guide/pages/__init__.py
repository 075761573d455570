"""Pages of the verification and validation guide, from guide.json."""
