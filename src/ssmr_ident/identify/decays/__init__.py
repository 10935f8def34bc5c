"""Free decays of one signal: start, poles, noise, uncertainty."""
