"""Models that a user describes, such as structures and grounds; they are validated when made."""
