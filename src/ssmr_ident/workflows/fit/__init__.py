"""``ident fit``."""
