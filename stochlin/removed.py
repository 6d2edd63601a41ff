"""What was removed and what to use instead, by the names in `removed.toml`.

Whoever still uses a name reads the clause in an error.
"""

from stochlin.files.package_data import data_of

REMOVED: dict[str, str] = data_of(__package__, "removed.toml")


def instead_of(name: str) -> str:
    """What an error says of a removed name, before what is allowed; empty for all other names."""
    return f"it was removed: {REMOVED[name]}; " if name in REMOVED else ""
