"""The second doctor: one search over models, one table, one decision; rigs first."""
