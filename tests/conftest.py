"""Shared configuration: makes ``tests/cases.py`` importable and property tests repeatable."""

from __future__ import annotations

import pytest
from hypothesis import settings
from opensees_models import load_opensees

# Examples follow from the test alone, and a slow machine does not make a test fail.
settings.register_profile("stochlin", deadline=None, derandomize=True, max_examples=60, database=None)
settings.load_profile("stochlin")


@pytest.fixture(scope="module")
def ops():
    """OpenSeesPy with an empty model; where it does not load the test is skipped, with the reason."""
    try:
        module = load_opensees()
    except ImportError as error:
        pytest.skip(str(error))
    yield module
    module.wipe()
