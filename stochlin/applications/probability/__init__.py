"""Probability of pounding: over time, in a record, and over intensity and gap."""
