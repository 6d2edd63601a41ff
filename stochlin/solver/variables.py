"""Units and long names of the variables of all tables, which are in `variables.toml`."""

from collections.abc import Mapping
from functools import cache

from stochlin.files.package_data import data_of

Variables = Mapping[str, tuple[str, str]]
NO_VARIABLES: Variables = {}
READ = data_of(__package__, "variables.toml")
VARIABLES_OF_RESULTS: Variables = {
    name: (units, words) for name, (units, words) in READ["variables"].items()
}
ENDINGS: Mapping[str, str] = READ["endings"]
RECORD_PREFIX = "record_"


def unit_and_long_name(name: str, special: Variables = NO_VARIABLES) -> tuple[str, str] | None:
    """Unit and long name of a variable; None if it has none.

    A name that is neither ``special`` nor in `VARIABLES_OF_RESULTS` may end as in `ENDINGS` or in
    the number of a structure, or begin with ``record_``, also in several ways at once. The rest has
    ``special`` words only where `VARIABLES_OF_RESULTS` has none for it.
    """
    return _described(name, special) if special else _usual(name)


@cache
def _usual(name: str) -> tuple[str, str] | None:
    return _described(name, NO_VARIABLES)


def _described(name: str, special: Variables) -> tuple[str, str] | None:
    if described := special.get(name) or VARIABLES_OF_RESULTS.get(name):
        return described
    rest = name.removeprefix(RECORD_PREFIX)
    text = "{}, in the record"
    if rest == name:
        for ending, words in ENDINGS.items():
            if name.endswith(f"_{ending}"):
                rest = name.removesuffix(f"_{ending}")
                text = words
        stem, _, number = name.rpartition("_")
        if number.isdigit():
            rest = stem
            text = f"{{}}, structure {number}"
    if rest == name:
        return None
    described = unit_and_long_name(rest) or (unit_and_long_name(rest, special) if special else None)
    if described is None:
        return None
    units, long_name = described
    return units, text.format(long_name)
