"""National Instruments TDMS."""
