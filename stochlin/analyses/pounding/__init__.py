"""What happens when they hit: histories of a row, estimate of a hit."""
