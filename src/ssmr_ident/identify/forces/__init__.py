"""What force logs say: ramps, saw-teeth, friction, springs."""
