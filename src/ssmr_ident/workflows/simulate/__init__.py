"""``ident simulate``: what is asked for, the table of what a baseline can be simulated in, and the log."""
