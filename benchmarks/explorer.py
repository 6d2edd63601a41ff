"""Memory of the explorer's server over many pages, and how soon it rests and ends.

    python benchmarks/explorer.py [loads] [questions]

``loads`` pages are asked for without a browser, which never connect. ``questions`` pages connect as a
browser does, ask for their charts, and are gone at once. The server's memory and the processor time of
its workers are those of ``/proc``, so that this needs Linux.
"""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path

import socketio  # that of NiceGUI
from tall_case import tower_and_annex

PROGRAM = "from stochlin.views.command import main; main()"
TICKS = os.sysconf("SC_CLK_TCK")
REST = 1.0  # s without work, after which a process rests


def main(loads: int = 2000, questions: int = 200) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    folder = tempfile.TemporaryDirectory()
    case = Path(folder.name, "case.toml")
    case.write_text(tower_and_annex(duration=20))
    command = [sys.executable, "-c", PROGRAM, "explore", "--no-open", "--port", str(port)]
    server = subprocess.Popen([*command, "--case", str(case)], stdout=subprocess.PIPE, text=True)
    try:
        follow(server, f"http://127.0.0.1:{port}/", loads, questions)
    finally:
        server.kill()
        folder.cleanup()


def follow(server: subprocess.Popen[str], address: str, loads: int, questions: int) -> None:
    """Print the memory of a server over many pages, and how it ends."""
    assert server.stdout is not None
    print(server.stdout.readline().strip())
    _ = seconds_until_rest(server.pid)
    print(f"memory at first {memory(server.pid):.0f} MB")
    for number in range(1, loads + 1):
        client_of(address)
        if number % (loads // 4) == 0:
            print(f"after {number} loads {memory(server.pid):.0f} MB")
    for number in range(1, questions + 1):
        asyncio.run(ask_and_leave(address))
        if number % (questions // 4) == 0:
            print(f"after {number} aborted questions {memory(server.pid):.0f} MB", flush=True)
    print(f"workers rest after {seconds_until_rest(server.pid):.1f} s")
    time.sleep(35)  # the server waits so long for a page to come back
    print(f"memory at last {memory(server.pid):.0f} MB")
    start = time.monotonic()
    server.send_signal(signal.SIGINT)
    server.wait(60)
    print(f"ended after {time.monotonic() - start:.2f} s")


def client_of(address: str) -> str:
    """The number that the server gives to a new page."""
    with urllib.request.urlopen(address) as response:
        found = re.search(r"client_id[^0-9a-f]+([0-9a-f-]{36})", response.read().decode())
    assert found
    return found[1]


async def ask_and_leave(address: str) -> None:
    """Connect as a browser does, wait until the page asks its questions, and go."""
    client = client_of(address)
    channel = socketio.AsyncClient(reconnection=False)
    query = f"client_id={client}&tab_id={client}&document_id={client}"
    query += "&next_message_id=0&implicit_handshake=true"
    place = {"socketio_path": "/_nicegui_ws/socket.io", "transports": ["websocket"], "wait_timeout": 60}
    await channel.connect(f"{address}?{query}", **place)
    await asyncio.sleep(0.3)
    await channel.disconnect()


def memory(process: int) -> float:
    """Memory in use [MB]."""
    status = Path(f"/proc/{process}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024  # type: ignore[index]


def seconds_until_rest(process: int) -> float:
    """Seconds until none of the server's processes works."""
    start = last = time.monotonic()
    before = work(process)
    while time.monotonic() - last < REST:
        time.sleep(0.1)
        now = work(process)
        if now - before > 0.02:
            last = time.monotonic()
        before = now
    return last - start


def work(process: int) -> float:
    """Processor time of the workers of a server so far [s]."""
    children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    stats = [Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split() for child in children]
    return sum(int(stat[11]) + int(stat[12]) for stat in stats) / TICKS


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
