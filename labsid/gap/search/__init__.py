"""Search for the effects that explain a record."""
