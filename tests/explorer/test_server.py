"""What the explorer's server refuses, and what it writes to its log."""

from __future__ import annotations

import pytest

from stochlin.views.explorer.server import allows

pytestmark = pytest.mark.cli


@pytest.mark.parametrize(
    ("host", "origin", "allowed"),
    [
        ("127.0.0.1:8640", "", True),
        ("localhost:8640", "http://localhost:8640", True),
        ("127.0.0.1:8640", "http://127.0.0.1:9999", False),
        ("127.0.0.1:8640", "http://evil.example", False),
        ("evil.example:8640", "http://evil.example:8640", False),
        ("127.0.0.1:8640", "null", False),
        ("", "", False),
        ("[", "", False),
        ("127.0.0.1:8640", "http://[bad", False),
    ],
)
def test_only_its_own_pages_may_ask(host, origin, allowed):
    headers = {b"host": host.encode()} | ({b"origin": origin.encode()} if origin else {})
    assert allows(headers) is allowed
