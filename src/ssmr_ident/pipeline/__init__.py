"""Corridor: the main jobs in order, each a short readable function."""
