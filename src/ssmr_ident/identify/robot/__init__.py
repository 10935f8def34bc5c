"""A robot's unknowns, what its recordings say of them, and their fit by the samples of its free responses."""
