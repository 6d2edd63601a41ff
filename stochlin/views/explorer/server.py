"""The explorer's server: one page, for this computer alone."""

from __future__ import annotations

import gc
import logging
import os
import socket
from contextlib import suppress
from importlib.resources import files
from typing import Any
from urllib.parse import urlsplit

import click
from nicegui import app, background_tasks, ui
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketClose

from stochlin.analyses.explorer.uploads import Upload
from stochlin.analyses.tables.inputs import MOST_BYTES
from stochlin.messages import LONGEST_MESSAGE, plain
from stochlin.views.explorer.answers import get_ready
from stochlin.views.explorer.page import NOT_SENT, Page
from stochlin.views.explorer.workers import ONE_THREAD, Job, Worker

HOST = "127.0.0.1"  # for this computer alone
NEVER_WITHIN = {"x-frame-options": "DENY", "content-security-policy": "frame-ancestors 'none'"}
MOST_BODY = MOST_BYTES + 2**20  # of a request: files, and what stands between them
PATIENCE = 10.0  # s that a page may take to connect, also after its connection was lost


class Guard:
    """Refuses requests for another host, from pages of another one, and with too large a body.

    Without it a page elsewhere could reach this one through the user's browser. Nor may one show it
    within itself.
    """

    def __init__(self, inner: Any) -> None:
        self._inner = inner

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer one request, or refuse it."""
        headers, answer, received = dict(scope.get("headers", ())), self._inner, 0

        async def send_with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(NEVER_WITHIN)
            await send(message)

        async def receive_limited() -> Any:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if max(received, int(headers.get(b"content-length", 0))) > MOST_BODY:
                raise HTTPException(413, NOT_SENT, {"connection": "close"})
            return message

        if scope["type"] in ("http", "websocket") and not allows(headers):
            refusal = PlainTextResponse("This host is not served here.\n", 403)
            answer = refusal if scope["type"] == "http" else WebSocketClose(1008)
        await answer(scope, receive_limited, send_with_headers)


def allows(headers: dict[bytes, bytes]) -> bool:
    """Whether ``Host`` is this computer, and ``Origin``, if there is one, the same."""
    host = headers.get(b"host", b"").decode("latin-1")
    origin = headers.get(b"origin", b"").decode("latin-1")
    try:
        named, elsewhere = urlsplit(f"//{host}").hostname, urlsplit(origin).netloc
    except ValueError:  # neither is an address
        return False
    return named in (HOST, "localhost") and (not origin or elsewhere == host)


def plain_record(*arguments: Any, **more: Any) -> logging.LogRecord:
    """A record of one line, without signs that a terminal obeys."""
    record = logging.LogRecord(*arguments, **more)
    said, error = record.getMessage(), record.exc_info and record.exc_info[1]
    if error:
        said = f"{said.partition(chr(10))[0]}: {type(error).__name__}: {error}"
    record.msg, record.args = plain(" ".join(said.split()), LONGEST_MESSAGE), ()
    record.exc_info = record.stack_info = None
    return record


def check_port(port: int) -> None:
    """Raise an OSError that says what to do if the port cannot be listened on."""
    try:
        with socket.socket() as probe:
            if os.name == "posix":  # elsewhere it would take a port from its owner
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((HOST, port))
    except OSError as error:
        raise OSError(
            f"--port {port} cannot be used ({error.strerror or error}); another program may use it: "
            "give another --port, or end that program"
        ) from error


def serve(start: Upload, port: int, show: bool) -> None:
    """Serve the page until it is interrupted; the port is one that `check_port` has passed."""
    os.environ.update(ONE_THREAD)  # of the worker; in this process linear algebra has begun
    worker = Worker()
    ui.add_css(f".answer {{\n{_css('shared')}\n}}\n{_css('explorer')}", shared=True)
    logging.setLogRecordFactory(plain_record)

    @ui.page("/")
    async def page() -> None:
        await ui.context.client.connected(PATIENCE)  # what only loads the page is not worth the controls
        Page(start, worker)

    async def ready() -> None:
        gc.freeze()  # so that a search for garbage is one of what pages leave, and not of all libraries
        background_tasks.create(worker.answer(Job(), get_ready))
        click.echo(f"The explorer is at http://{HOST}:{port} (Ctrl+C ends it)")

    app.add_exception_handler(404, lambda *_: PlainTextResponse("This is not served here.\n", 404))
    app.on_startup(ready)
    app.on_shutdown(worker.close)
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
            favicon="\N{BAR CHART}",
        )
    gc.freeze()  # the interpreter would otherwise look for garbage for a second or two as it ends


def _css(view: str) -> str:
    return files(f"stochlin.views.{view}").joinpath("page.css").read_text(encoding="utf-8")
