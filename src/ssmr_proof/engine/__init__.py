"""The robot as a MuJoCo model, and its run."""
