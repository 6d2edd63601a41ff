"""Design atlases: tables of the correlation that may be larger than memory, stored on disk."""
