"""Top floor: what a person sees. Draws and prints what the floors below found, computes nothing."""
