"""Foundations: recordings, parameters, errors, the compiler switch. Imports nothing else of the package."""
