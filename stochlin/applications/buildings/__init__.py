"""Buildings as other programs print them: tables of modes and pushover curves."""
