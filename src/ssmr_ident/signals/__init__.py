"""Laundry: pure functions on samples (filters, spectra, peaks, mains hum, distances). Arrays in, values out."""
