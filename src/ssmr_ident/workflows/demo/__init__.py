"""``ident demo``."""
