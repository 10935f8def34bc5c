"""The plant: a robot and a rig in MuJoCo whose physics shares no law with the bundled simulator."""
