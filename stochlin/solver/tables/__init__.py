"""Labelled tables of all rooms: names and units, broadcasting, checks of arguments."""
