"""A rig's mass, spring and damper from measured force and motion."""
