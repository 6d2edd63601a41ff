"""Published formulas, selected by name: code rules, effective properties, peak factors."""
