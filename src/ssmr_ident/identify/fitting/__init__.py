"""All recordings of a session fitted together."""
