"""The data of the figures of the paper."""
