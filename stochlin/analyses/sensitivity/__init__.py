"""What matters for a gap: shares of its variance, and its slopes, by parameter."""
