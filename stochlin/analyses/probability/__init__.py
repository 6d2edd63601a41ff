"""How likely they hit: over time, by record, over intensity and gap."""
