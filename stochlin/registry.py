"""Extensions by name: a registry for each kind, one file for each extension.

The modules of the kind's own folder are imported when a name is first asked for, and so are those
that installed packages announce as entry points of the group ``stochlin.extensions``. Each
registers what it defines; nothing else lists the names. One that cannot be imported is named by a
warning, and the others still work.
"""

from __future__ import annotations

import importlib
import pkgutil
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from importlib.metadata import entry_points
from pathlib import Path
from threading import RLock
from typing import Any, Generic, TypeVar

from stochlin.messages import brief, sentence

Thing = TypeVar("Thing")
Defined = TypeVar("Defined")
GROUP = "stochlin.extensions"
LAST = 1000


class Registry(Mapping[str, Thing], Generic[Thing]):
    """All extensions of one kind, by name.

    Parameters
    ----------
    kind : str
        What they are called in messages, ``"ground"``.
    folder : str
        The package whose modules define them.
    module : str, optional
        Only the modules of this name do, one in each folder within.
    check : callable, optional
        Raises a ValueError for a thing that lacks what is needed.
    """

    def __init__(
        self,
        kind: str,
        folder: str,
        module: str | None = None,
        check: Callable[[Any], None] | None = None,
    ) -> None:
        self.kind = kind
        self.folder = folder
        self.module = module
        self.check = check
        self._things: dict[str, Thing] = {}
        self._places: dict[str, tuple[int, str]] = {}
        self._asked = False
        self._lock = RLock()

    def register(self, name: str, place: int = LAST) -> Callable[[Defined], Defined]:
        """A decorator that makes what it stands on known by this name.

        Lists show what has a lower ``place`` first, and all of one place by name. A name that is
        taken raises a ValueError, and so does a thing that fails the check of the registry.
        """

        def add(thing: Defined) -> Defined:
            if name in self._things:
                raise ValueError(f"{self.kind} {name!r} exists already; choose another name")
            if self.check is not None:
                self.check(thing)
            self._things[name] = thing  # type: ignore[assignment]
            self._places[name] = place, name
            return thing

        return add

    def named(self, name: object, parameter: str = "name", others: Iterable[str] = ()) -> Thing:
        """The extension of this name, in any case, with ``-`` or ``_``.

        A ValueError lists all names, and the ``others`` that are allowed in its place.
        """
        key = as_key(name)
        if key not in self:
            allowed = ", ".join([*self, *others])
            what = f"is not a known {self.kind}"
            raise ValueError(f"{parameter} = {brief(name)} {what}; allowed: {allowed}")
        return self[key]

    def __getitem__(self, name: str) -> Thing:
        return self._found()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._found(), key=self._places.__getitem__))

    def __len__(self) -> int:
        return len(self._found())

    def _found(self) -> Mapping[str, Thing]:
        with self._lock:
            if not self._asked:
                # a module that asks while it is imported sees what is there so far
                self._asked = True
                try:
                    for name in self._modules():
                        _import(name, partial(importlib.import_module, name))
                    import_extensions()
                except BaseException:
                    self._asked = False  # whoever asks next is told, too
                    raise
        return self._things

    def _modules(self) -> Iterator[str]:
        package = importlib.import_module(self.folder)
        if self.module is None:
            names = [module.name for module in pkgutil.iter_modules(package.__path__)]
        else:
            files = [
                file for path in package.__path__ for file in Path(path).glob(f"*/{self.module}.py")
            ]
            names = sorted(f"{file.parent.name}.{self.module}" for file in files)
        return (f"{self.folder}.{name}" for name in names)


def as_key(name: object) -> str:
    """A name as registries keep it, from what a user writes."""
    return str(name).strip().lower().replace("-", "_")


def expect_class(thing: Any, base: type, *required: str) -> None:
    """Raise a ValueError for what is no class of a ``base`` or lacks what the base leaves to it."""
    if not (isinstance(thing, type) and issubclass(thing, base)):
        raise ValueError(
            f"{brief(thing)} is registered; allowed: a class derived from {base.__name__}"
        )
    for name in required:
        if getattr(thing, name, None) is getattr(base, name, None):
            raise ValueError(
                f"{thing.__name__} has no {name}, which a class of {base.__name__} needs"
            )


@cache
def import_extensions() -> None:
    """Import the modules that installed packages announce."""
    for entry in entry_points(group=GROUP):
        _import(f"{entry.name!r} ({entry.value})", entry.load)


def _import(extension: str, load: Callable[[], object]) -> None:
    """Import one, or warn that it cannot be imported."""
    try:
        load()
    except Exception as error:
        what = f"the extension {extension} is not used, since it cannot be imported"
        why = f"{type(error).__name__}: {sentence(error)}"
        warnings.warn(f"{what} ({why}); mend or remove it", stacklevel=2)
