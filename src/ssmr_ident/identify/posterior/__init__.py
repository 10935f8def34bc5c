"""Parameters from many small results, the user's own knowledge as prior, and how they print."""
