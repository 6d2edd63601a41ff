"""Published formulas found by name, one class each: code rules, effective properties, peak factors."""
