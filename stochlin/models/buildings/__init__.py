"""Buildings with floors: as a row of storeys, or by their modes."""
