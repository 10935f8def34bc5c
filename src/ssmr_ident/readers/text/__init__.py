"""Delimited text of any dialect."""
