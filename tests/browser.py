"""Chromium on the page of the explorer, by keyboard and script."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

PROGRAM = "from stochlin.views.command import main; main()"
PATIENCE = 60.0  # s, on a machine that is busy
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    "--disable-dev-shm-usage",
)
IDLE = """const state = document.querySelector('[data-state]');
    const shown = [...document.querySelectorAll('.answer')].find(e => e.offsetParent);
    const alert = document.querySelector('[data-alert]');
    return state?.textContent === '' && (!!alert.textContent || !!shown?.matches(':not(.stale)'))"""


def listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def wait(done: Any, seconds: float = PATIENCE) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


@contextmanager
def served(folder: Path, case: str) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Address and process of a server of the page, which says where it is, and leaves nothing."""
    (folder / "case.toml").write_text(case, encoding="utf-8")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    # NiceGUI looks for this variable and would wait for a test runner of its own.
    environment = {name: text for name, text in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    environment["TMPDIR"] = tempfile.mkdtemp(dir=folder)
    command = [sys.executable, "-c", PROGRAM, "explore", "--no-open", "--port", str(port)]
    log = folder / "log.txt"
    with log.open("w") as stream:
        server = subprocess.Popen(
            [*command, "--case", "case.toml"],
            cwd=folder,
            env=environment,
            stdout=stream,
            stderr=subprocess.STDOUT,
        )
    try:
        wait(lambda: "Ctrl+C" in log.read_text() or server.poll() is not None)
        assert server.poll() is None, log.read_text()
        wait(lambda: listens(port))  # it says where it is just before it listens
        yield f"127.0.0.1:{port}", server
    finally:
        server.terminate()
        server.wait(PATIENCE)
    assert not os.listdir(environment["TMPDIR"])
    assert log.read_text() == f"The explorer is at http://127.0.0.1:{port} (Ctrl+C ends it)\n"


class Browser:
    """Chromium on the page, by keyboard and script."""

    def __init__(self, driver: Any, downloads: Path) -> None:
        self.driver, self.downloads = driver, downloads

    def script(self, text: str, *arguments: Any) -> Any:
        return self.driver.execute_script(text, *arguments)

    def open(self, address: str, width: int = 1200, height: int = 900) -> None:
        """The page as it begins."""
        self.width = width
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        self.driver.get(f"http://{address}/")
        wait(lambda: self.script(IDLE), 5 * PATIENCE)  # the first answer may have to be compiled

    def idle(self) -> None:
        wait(lambda: self.script(IDLE))

    def press(self, *keys: str) -> None:
        from selenium.webdriver import ActionChains

        ActionChains(self.driver).send_keys(*keys).perform()

    def enter(self, name: str, text: str) -> None:
        """Type another value of a key, like "building_1.period", and wait for what it changes."""
        self.script("document.querySelector(arguments[0]).select()", f'[data-entry="{name}"]')
        self.press(text)
        time.sleep(0.6)  # longer than an entry waits for another key
        self.idle()

    def click(self, mark: str) -> None:
        self.driver.find_element("css selector", f"[data-{mark}]").click()

    def text(self, mark: str) -> str:
        text = "return document.querySelector(arguments[0]).textContent"
        return str(self.script(text, f"[data-{mark}]"))

    def value(self, mark: str) -> str:
        value = "return document.querySelector(arguments[0])?.value"
        return str(self.script(value, f"[data-{mark}]"))

    def gap(self) -> str:
        """The first sentence of the answer."""
        first = "return document.querySelector('.answer p.answer').textContent"
        return str(self.script(first)).replace("\N{NO-BREAK SPACE}", " ")

    def send(self, *files: Path) -> None:
        """Choose these files to be opened."""
        entry = self.driver.find_element("css selector", "input[type=file]")
        entry.send_keys("\n".join(map(str, files)))

    def downloaded(self, name: str) -> Path:
        path = self.downloads / name
        wait(path.exists)
        return path.rename(
            path.with_stem(f"{path.stem} {time.monotonic_ns()}")
        )  # the next has its name
