"""Pictures of sites: the spectrum of the motions, beside the target."""
