"""What matters for a gap, in words and as a picture."""
