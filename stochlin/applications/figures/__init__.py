"""The data of the figures of the paper, and of those that compare methods."""
