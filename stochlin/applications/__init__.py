"""Third floor: what uses the solver: gaps, codes, records, sites, pounding, risk. Datasets out."""
