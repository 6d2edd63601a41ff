"""Top floor: what a person sees. Draws and prints what the analyses found, computes nothing."""
