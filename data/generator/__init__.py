"""The experiments of the reference campaign and what they were made with."""
