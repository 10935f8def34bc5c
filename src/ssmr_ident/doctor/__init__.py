"""The doctor of rigs: one search over models, one table, one decision."""
