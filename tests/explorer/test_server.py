"""What the explorer's server refuses, and what it writes to its log."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator

import httpx
import pytest
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from stochlin.views.explorer.server import HOST, MOST_BODY, Guard, allows, plain_record

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


def answered(count: int, **headers: str) -> tuple[int, int]:
    """Status of the answer to a request of so many MiB, and how many of them were read."""
    read = []

    async def body() -> AsyncIterator[bytes]:
        for number in range(count):
            read.append(number)
            yield bytes(2**20)

    async def size(request: Request) -> Response:
        return Response(str(len(await request.body())))

    async def status() -> int:
        route = Route("/", size, methods=["POST"])
        served = httpx.ASGITransport(Starlette(False, [route], [Middleware(Guard)]))
        async with httpx.AsyncClient(transport=served, base_url=f"http://{HOST}") as client:
            return (await client.post("/", content=body(), headers=headers)).status_code

    return asyncio.run(status()), len(read)


def test_a_body_that_is_too_large_is_refused_without_its_rest():
    assert answered(2) == (200, 2)
    assert answered(1000) == (413, (MOST_BODY >> 20) + 1)  # in chunks, of which no length is stated
    assert answered(1000, **{"content-length": f"{MOST_BODY + 1}"}) == (413, 1)


def test_a_record_of_the_log_is_one_line_that_no_terminal_obeys():
    error = ValueError("\x1b[31mred\nand more")
    info = type(error), error, None
    record = plain_record("", logging.ERROR, "a.py", 1, "of %s\nTraceback", ("\x1b[2J",), info)
    line = "of \\x1b[2J: ValueError: \\x1b[31mred and more"
    assert logging.Formatter().format(record) == line
