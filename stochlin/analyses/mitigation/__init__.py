"""What would help: measures compared, the least that does."""
