"""The laws: robot, tires, motor, cable, sensor. Values and pure functions; nothing here integrates anything."""
