"""HDF5, and MATLAB files of version 7.3, which are HDF5."""
