"""Published reference cases: data only, one folder per publication and edition."""
