"""Pictures of sites: the spectrum that motions have, beside the one that is wanted."""
