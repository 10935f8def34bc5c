"""The doctor of a robot's free decays: linear models exactly, laws by simulation, one table, one decision."""
