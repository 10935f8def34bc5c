"""The replication of the 2012 thesis: each of its statements against what ssmr_ident finds."""
