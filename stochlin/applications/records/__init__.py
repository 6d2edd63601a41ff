"""Strong-motion records: reading, fits of grounds and envelopes, and the response of structures."""
