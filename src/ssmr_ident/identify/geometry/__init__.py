"""Centre of mass, contact points and inertia from lengths, weighings and parts."""
