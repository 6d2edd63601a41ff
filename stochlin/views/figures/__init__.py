"""The figures of the paper and those of a record: the data and picture of each in one module."""
