"""What a case hides, drawn from a seed."""
