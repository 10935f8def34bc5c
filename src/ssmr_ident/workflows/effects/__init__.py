"""``ident effects``."""
