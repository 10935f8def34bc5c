"""``ident new``."""
