"""What searches of decays and of forces share: what has been fitted, what may be added, and the answer."""
