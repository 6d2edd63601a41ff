"""A package from outside that extends stochlin: installed in a folder, used from a command line."""

import os
import sys

import pytest
from commands import process
from extending import examples


@pytest.fixture
def example():
    """``example(title, registry)`` runs the example of a section here, until the test is over."""
    added = []

    def registered(title, registry):
        known = set(registry)
        names = {"__name__": "toy_example"}
        exec(compile(examples()[title], "toy_example", "exec"), names)
        added.extend((registry, name) for name in set(registry) - known)
        return registry[added[-1][1]]

    yield registered
    for registry, name in added:
        del registry._things[name], registry._places[name]


@pytest.fixture
def install(tmp_path):
    """``install(source)`` installs a module ``toy``; returns a runner of ``stochlin`` there."""

    def installed(source):
        (tmp_path / "toy.py").write_text(source, encoding="utf-8")
        about = tmp_path / "toy-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[stochlin.extensions]\ntoy = toy\n")
        path = {"PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(None, sys.path)])}
        start = "-W", "error", "-m", "stochlin"
        return lambda *arguments: process(tmp_path, path, *start, *map(str, arguments))

    return installed


@pytest.fixture
def toy(install):
    """A runner of ``stochlin`` with all examples of the page, as a reader would copy them."""
    return install("\n".join(examples().values()))
