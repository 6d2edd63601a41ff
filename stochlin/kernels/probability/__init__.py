"""Level crossings, random phases, growth of the drift."""
