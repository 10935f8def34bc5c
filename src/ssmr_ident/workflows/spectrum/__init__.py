"""``ident spectrum``."""
