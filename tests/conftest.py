"""Shared configuration: makes ``tests/cases.py`` importable and property tests repeatable."""

from __future__ import annotations

from hypothesis import settings

# Examples follow from the test alone, and a slow machine does not make a test fail.
settings.register_profile("stochlin", deadline=None, derandomize=True, max_examples=60, database=None)
settings.load_profile("stochlin")
