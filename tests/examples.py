"""The arguments of the first call of a public name in the example of its docstring."""

import doctest
import inspect
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest

import stochlin as sl


class Called(BaseException):
    """The arguments of the first call of a public name in its example."""

    def __init__(self, call: Callable[..., Any], *args: Any, **options: Any) -> None:
        self.arguments = inspect.signature(call).bind(*args, **options).arguments


class Stopped:
    """A public name that is not called."""

    def __init__(self, thing: Any) -> None:
        self._thing = thing

    def __call__(self, *args: Any, **options: Any) -> None:
        raise Called(self._thing, *args, **options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._thing, name)


def example_arguments(name: str, folder: Path) -> dict[str, Any]:
    """As in the example of the reference, which writes its files into this folder."""
    call = attrgetter(name)(sl)
    holder, _, own = f"sl.{name}".rpartition(".")
    examples = doctest.DocTestParser().get_examples(inspect.getdoc(call))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tempfile.tempdir", str(folder))
        patch.setattr(eval(holder), own, Stopped(call))
        try:
            exec("".join(example.source for example in examples), {})
        except Called as called:
            return called.arguments
    raise AssertionError(f"the example of {name} does not call it")
