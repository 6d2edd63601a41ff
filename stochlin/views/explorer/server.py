"""The explorer's server: one page, for this computer alone by default."""

from __future__ import annotations

import gc
import logging
import os
import socket
from contextlib import suppress
from functools import partial
from importlib.resources import files
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

import click
from nicegui import Client, app, ui
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketClose

from stochlin.analyses.explorer.uploads import Upload
from stochlin.analyses.tables.inputs import MOST_BYTES
from stochlin.messages import LONGEST_MESSAGE, plain
from stochlin.views.explorer.answers import get_ready
from stochlin.views.explorer.page import NOT_SENT, Page
from stochlin.views.explorer.workers import ONE_THREAD, Worker

LOCAL = "localhost"
NEVER_WITHIN = {"x-frame-options": "DENY", "content-security-policy": "frame-ancestors 'none'"}
MOST_BODY = MOST_BYTES + 2**20  # of a request: files, and what stands between them
MOST_WAITING = 32  # pages that were asked for and have not connected
PATIENCE, HASTE = 30.0, 3.0  # s that a page may take to connect; among too many, and loads itself anew


class Guard:
    """Refuses requests for another host, from pages of another one, and with too large a body.

    Without it a page elsewhere could reach this one through the user's browser. Nor may one show it
    within itself.
    """

    def __init__(self, inner: Any, names: frozenset[str] | None) -> None:
        self._inner, self._names = inner, names  # None: any, where all addresses are listened on

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

        if scope["type"] in ("http", "websocket") and not self.allows(headers):
            refusal = PlainTextResponse("This host is not served here.\n", 403)
            answer = refusal if scope["type"] == "http" else WebSocketClose(1008)
        await answer(scope, receive_limited, send_with_headers)

    def allows(self, headers: dict[bytes, bytes]) -> bool:
        """Whether ``Host`` is one of ours, and ``Origin``, if there is one, the same."""
        host = headers.get(b"host", b"").decode("latin-1")
        origin = headers.get(b"origin", b"").decode("latin-1")
        try:
            named, elsewhere = urlsplit(f"//{host}").hostname, urlsplit(origin).netloc
        except ValueError:  # neither is an address
            return False
        if self._names is not None and named not in self._names:
            return False
        return not origin or elsewhere == host


def plain_record(*arguments: Any, **more: Any) -> logging.LogRecord:
    """A record of one line, without signs that a terminal obeys."""
    record = logging.LogRecord(*arguments, **more)
    said, error = record.getMessage(), record.exc_info and record.exc_info[1]
    if error:
        said = f"{said.partition(chr(10))[0]}: {type(error).__name__}: {error}"
    record.msg, record.args = plain(" ".join(said.split()), LONGEST_MESSAGE), ()
    record.exc_info = record.stack_info = None
    return record


def names_of(host: str) -> frozenset[str] | None:
    """Names under which a browser may ask for what listens at ``host``; None for any."""
    try:
        address = ip_address(host)
    except ValueError:
        return frozenset({host, "127.0.0.1", "::1"} if host == LOCAL else {host})
    if address.is_unspecified:
        return None
    return frozenset({host, LOCAL} if address.is_loopback else {host})


def check_address(host: str, port: int) -> None:
    """Raise an OSError that says what to do if the address cannot be listened on."""
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family) as probe:
            if os.name == "posix":  # elsewhere it would take a port from its owner
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        raise OSError(
            f"--host {host} --port {port} cannot be used ({error.strerror or error}); another program "
            "may use the port: give another --port, or end that program"
        ) from error


def serve(start: Upload, host: str, port: int, show: bool) -> None:
    """Serve the page until it is interrupted; the address is one that `check_address` has passed."""
    os.environ.update(ONE_THREAD)  # of the worker; in this process linear algebra has begun
    worker = Worker()
    ui.add_css(f".answer {{\n{_css('shared')}\n}}\n{_css('explorer')}", shared=True)
    logging.setLogRecordFactory(plain_record)
    waiting: set[Client] = set()

    @ui.page("/")
    async def page() -> None:
        client = ui.context.client
        waiting.add(client)
        try:  # what only loads the page is not worth the controls
            await client.connected(PATIENCE if len(waiting) <= MOST_WAITING else HASTE)
        finally:
            waiting.remove(client)
        if not client.is_deleted:
            Page(start, worker).begin()

    def ready() -> None:
        gc.freeze()  # so that a search for garbage is one of what pages leave, and not of all libraries
        worker.ask(get_ready)
        shown = f"[{host}]" if ":" in host else host
        click.echo(f"The explorer is at http://{shown}:{port} (Ctrl+C ends it)")
        if LOCAL not in (names_of(host) or ()):
            click.echo("Everyone who can reach this computer over the network can open it.")

    app.add_exception_handler(404, lambda *_: PlainTextResponse("This is not served here.\n", 404))
    app.on_startup(ready)
    app.on_shutdown(worker.close)
    app.on_delete(partial(gc.collect, 2))  # the parts of a page refer to one another
    app.add_middleware(Guard, names=names_of(host))
    with suppress(KeyboardInterrupt):
        ui.run(
            host=host,
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
