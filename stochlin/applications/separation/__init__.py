"""Required separation of buildings: by simulation, eq. (3) and codes, and limits of an existing gap."""
