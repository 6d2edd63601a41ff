"""Sites: design spectra, grounds fitted to spectra or records, and suites of records."""
