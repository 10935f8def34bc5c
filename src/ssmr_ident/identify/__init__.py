"""Parameters from recordings, with uncertainties: a folder per kind of recording, and fitting/ for all of them."""
