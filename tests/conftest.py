"""Shared configuration: makes ``tests/cases.py`` importable and property tests repeatable."""

import gc

import pytest
from hypothesis import settings

# Examples follow from the test alone, and a slow machine does not make a test fail.
settings.register_profile("all", deadline=None, derandomize=True, max_examples=60, database=None)
settings.register_profile("short", settings.get_profile("all"), max_examples=20)

gc.disable()  # while tests are collected, of which it would take a third of the time


def pytest_collection_finish():
    gc.enable()


def pytest_configure(config):
    """``make test`` draws a third of the examples of ``make test-all``."""
    settings.load_profile("short" if "not slow" in config.option.markexpr else "all")


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(items):
    """Property tests and extreme ones have buildings that are allowed, and that nobody has."""
    for item in items:
        if isinstance(item, pytest.DoctestItem):  # an example of the reference
            item.add_marker("cli")
        drawn = getattr(getattr(item, "obj", None), "is_hypothesis_test", False)
        if drawn or item.get_closest_marker("extreme"):
            item.add_marker(
                pytest.mark.filterwarnings("ignore::stochlin.messages.ImplausibleInput")
            )


@pytest.fixture(scope="session", autouse=True)
def coarse_pictures():
    """Pictures with few points an inch, which take a third of the time of those for print."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("stochlin.views.shared.style.PRINT", 72)
        yield
