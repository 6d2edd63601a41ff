"""The explorer's server: one page, for this computer alone."""

from __future__ import annotations

import gc
import re
import socket
from contextlib import suppress
from importlib.resources import files
from typing import Any
from urllib.parse import urlsplit

import click
from nicegui import app, background_tasks, ui
from starlette.datastructures import MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketClose

from stochlin.applications.explorer.uploads import Upload
from stochlin.files.inputs import MOST_BYTES
from stochlin.views.explorer import answers
from stochlin.views.explorer.page import Page
from stochlin.views.explorer.workers import Job, Worker

HOST = "127.0.0.1"  # for this computer alone
NEVER_WITHIN = {"x-frame-options": "DENY", "content-security-policy": "frame-ancestors 'none'"}
MOST_SENT = MOST_BYTES + 2**20  # bytes of files in a request, and of what it says about them
TOO_MUCH = PlainTextResponse(f"This is more than {MOST_BYTES >> 20} MiB.\n", 413)
PATIENCE = 10.0  # s that a page may take to connect, also after its connection was lost


class TooMuch(Exception):  # noqa: N818
    """A request with more bytes than are allowed."""


class Guard:
    """Refuses requests for another host, from pages of another one, and with too much in them.

    Without it a page elsewhere could reach this one through the user's browser. Nor may one show it
    within itself. What a browser checks before it sends files is checked here again, by the length
    that a request states and by what comes.
    """

    def __init__(self, inner: Any) -> None:
        self._inner = inner

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer one request, or refuse it."""
        received = 0
        begun = False

        async def receive_counted() -> Any:
            nonlocal received
            message = await receive()
            if message["type"] == "http.request":
                received += len(message.get("body", b""))
                if received > MOST_SENT:
                    raise TooMuch
            return message

        async def send_with_headers(message: Any) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                MutableHeaders(scope=message).update(NEVER_WITHIN)
            await send(message)

        answer = self._inner
        if scope["type"] in ("http", "websocket"):
            headers = dict(scope["headers"])
            if not allows(headers):
                refusal = PlainTextResponse("This host is not served here.\n", 403)
                answer = refusal if scope["type"] == "http" else WebSocketClose(1008)
            elif not stated_length(headers) <= MOST_SENT:
                answer = TOO_MUCH
        try:
            await answer(scope, receive_counted, send_with_headers)
        except TooMuch:
            if not begun:
                await TOO_MUCH(scope, receive, send_with_headers)


def stated_length(headers: dict[bytes, bytes]) -> float:
    """The bytes that a request says it has; infinite if that is no number."""
    text = headers.get(b"content-length", b"0")
    return int(text) if re.fullmatch(rb"\d{1,18}", text) else float("inf")


def allows(headers: dict[bytes, bytes]) -> bool:
    """Whether ``Host`` is this computer, and ``Origin``, if there is one, the same."""
    host = headers.get(b"host", b"").decode("latin-1")
    origin = headers.get(b"origin", b"").decode("latin-1")
    try:
        named = urlsplit(f"//{host}").hostname
        elsewhere = urlsplit(origin).netloc
    except ValueError:  # neither is an address
        return False
    return named in (HOST, "localhost") and (not origin or elsewhere == host)


def check_port(port: int) -> None:
    """Raise an OSError that says what to do if the port cannot be listened on."""
    try:
        socket.create_server((HOST, port)).close()
    except OSError as error:
        what = f"--port {port} cannot be used ({error.strerror or error})"
        raise OSError(f"{what}; another program may use it: give another --port") from error


def serve(start: Upload, port: int, show: bool) -> None:
    """Serve the page until it is interrupted; the port is one that `check_port` has passed."""
    worker = Worker(answers.__name__)
    of_page = files("stochlin.views.shared") / "page.css"
    of_explorer = files("stochlin.views.explorer") / "page.css"
    ui.add_css(f".answer {{\n{of_page.read_text()}\n}}\n{of_explorer.read_text()}", shared=True)

    @ui.page("/")
    async def page() -> None:
        # A program that only loads the page is not worth the controls.
        await ui.context.client.connected(PATIENCE)
        Page(start, worker)

    async def ready() -> None:
        # So that a search for garbage is one of what pages leave, and not of all libraries:
        gc.freeze()
        background_tasks.create(worker.answer(Job(), answers.READY))
        click.echo(f"The explorer is at http://{HOST}:{port} (Ctrl+C ends it)")

    app.add_exception_handler(404, lambda *_: PlainTextResponse("This is not served here.\n", 404))
    app.on_startup(ready)
    app.on_shutdown(worker.stop)
    app.add_middleware(Guard)
    with suppress(KeyboardInterrupt):
        ui.run(
            host=HOST,
            port=port,
            title="stochlin explore",
            show=show,
            reload=False,
            tailwind=False,
            show_welcome_message=False,
            reconnect_timeout=PATIENCE,
        )
    gc.freeze()  # the interpreter would otherwise look for garbage for a second or two as it ends
