"""Risk of pounding: its annual frequency from the hazard of a site, and the gap for an allowed risk."""
