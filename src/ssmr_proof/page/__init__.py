"""proof.html and its figures."""
