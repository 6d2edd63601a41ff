"""Sites: design spectra, grounds that deliver them, motions with the energy of a record."""
