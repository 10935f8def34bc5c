"""A robot's body and tires from its free responses."""
