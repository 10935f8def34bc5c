"""What a diagnosis claims against the truth, counted."""
