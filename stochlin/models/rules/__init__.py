"""Published formulas found by name: code rules, effective properties, peak factors."""
