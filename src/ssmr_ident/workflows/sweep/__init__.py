"""``ident sweep``: the simulator over a grid (thesis appendix C)."""
