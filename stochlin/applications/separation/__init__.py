"""Required separation of buildings: by simulation, eq. (3) and codes; limits of an existing gap."""
