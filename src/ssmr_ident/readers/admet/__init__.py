"""ADMET's XML of samples."""
