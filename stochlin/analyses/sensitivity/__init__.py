"""Sensitivity of the gap to each input: shares of the variance, slopes and elasticities."""
