"""What was read from files, fitted or simulated for a case, kept for other cases of the same files."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, TypeVar

Found = TypeVar("Found")
MOST = 16  # results of one kind


class Known(dict[str, Any]):
    """Results by what they are of: contents of files, and grounds that were fitted or scaled."""

    def of(self, what: str, values: Any, find: Callable[[], Found]) -> Found:
        """The result for these values of a file, found now if it is not known yet."""
        name = name_of(what, values)
        if name not in self:
            self.keep(name, find())
        found: Found = self[name]
        return found

    def keep(self, name: str, found: Any) -> None:
        """Add a result; of those of one kind the oldest goes, where there are too many."""
        kind = name.partition(" ")[0]
        alike = [other for other in self if other.partition(" ")[0] == kind]
        if len(alike) >= MOST:
            del self[alike[0]]
        self[name] = found


def name_of(what: str, values: Any) -> str:
    """The name of a result: the same for equal values, which come from a TOML file."""
    return f"{what} {json.dumps(values, sort_keys=True, default=str)}"
