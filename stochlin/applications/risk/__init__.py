"""Risk of pounding: its annual frequency from a site's hazard, and the gap for an allowed risk."""
