"""Two oscillators: eq. (4), the compiled table of pairs, signatures."""
