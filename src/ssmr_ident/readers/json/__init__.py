"""JSON: an object a line, or named arrays."""
