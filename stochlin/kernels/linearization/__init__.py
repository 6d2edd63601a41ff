"""One oscillator: covariances, filters, closures, fixed point, moments over time, drift."""
