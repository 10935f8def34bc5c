"""Universal files."""
