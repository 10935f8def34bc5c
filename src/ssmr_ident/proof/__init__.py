"""Proving ground: the same robot in engines that nobody here wrote."""
