"""What the explorer's server refuses, and what it writes to its log."""

from __future__ import annotations

import asyncio

import pytest

from stochlin.views.explorer.server import MOST_SENT, Guard, allows

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


PIECE = 2**20


def posted(size: int, headers: dict[str, str]) -> tuple[int, int]:
    """The status of a request with so many bytes, and how many of them reached the pages."""
    taken = 0
    sent: list[int] = []

    async def pages(scope, receive, send):
        nonlocal taken
        more = True
        while more:
            message = await receive()
            taken += len(message["body"])
            more = message["more_body"]
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b""})

    left = [size]

    async def receive():
        part = min(PIECE, left[0])
        left[0] -= part
        return {"type": "http.request", "body": bytes(part), "more_body": left[0] > 0}

    async def send(message):
        if message["type"] == "http.response.start":
            sent.append(message["status"])

    raw = [
        (name.encode(), text.encode()) for name, text in {"host": "localhost", **headers}.items()
    ]
    scope = {"type": "http", "method": "POST", "path": "/", "headers": raw}
    asyncio.run(Guard(pages)(scope, receive, send))
    (status,) = sent
    return status, taken


def test_more_than_is_allowed_is_refused_by_its_length_and_by_what_comes():
    """Nothing of it is stored, or no more than allowed if it does not say how much it has."""
    assert posted(MOST_SENT, {}) == (200, MOST_SENT)
    assert posted(2**30, {}) == (413, MOST_SENT // PIECE * PIECE)
    for length in (str(2**30), "1e3", "-1", "9" * 5000):
        assert posted(2**30, {"content-length": length}) == (413, 0)
    assert posted(2**30, {"content-length": "10"})[0] == 413
