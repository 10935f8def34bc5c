"""Zips with logs in them."""
