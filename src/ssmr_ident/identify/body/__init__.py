"""What a robot's accelerometers show of its body and tires in a free response."""
