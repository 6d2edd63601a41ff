"""Strong motions: read, fit a ground or an envelope, follow a structure through them."""
