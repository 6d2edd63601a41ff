"""Chromium on the page of the explorer, by keyboard and script."""

from __future__ import annotations

import socket
import time
from pathlib import Path
from typing import Any

PROGRAM = "from stochlin.views.command import main; main()"
PATIENCE = 60.0  # s, on a machine that is busy
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    "--disable-dev-shm-usage",
)
IDLE = (
    "const s = [...document.querySelectorAll('.state')];"
    "return s.length == 4 && s.every(e => !e.textContent) && "
    "[...document.querySelectorAll('.chart')].every(e => e.querySelector('.main-svg'))"
)

# All that is seen: words, entries, switches, curves.
SEEN = """return JSON.stringify([innerWidth, document.body.className, document.body.innerText,
    [...document.querySelectorAll('input')].map(e => e.value),
    [...document.querySelectorAll('[role=switch]')].map(e => e.ariaChecked),
    [...document.querySelectorAll('.chart')].map(e => e.data)])"""


def listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def wait(done: Any, seconds: float = PATIENCE) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


class Browser:
    """Chromium on the page, by keyboard and script."""

    def __init__(self, driver: Any, downloads: Path) -> None:
        self.driver, self.downloads = driver, downloads
        self._opened: dict[str, object] = {}

    def script(self, text: str, *arguments: Any) -> Any:
        return self.driver.execute_script(text, *arguments)

    def open(self, address: str, width: int = 1200, height: int = 900) -> None:
        """The page as it begins: loaded anew, unless all is as it was when it was opened so."""
        self.width = width
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        asked = {"address": address, **size}
        if self._opened == asked | {"seen": self.script(SEEN)}:
            return  # it is as it began
        self.driver.get(f"http://{address}/")
        self.idle()
        self._opened = asked | {"seen": self.script(SEEN)}

    def idle(self) -> None:
        wait(lambda: self.script(IDLE))

    def press(self, *keys: str) -> None:
        from selenium.webdriver import ActionChains

        ActionChains(self.driver).send_keys(*keys).perform()

    def enter(self, name: str, text: str) -> None:
        from selenium.webdriver.common.keys import Keys

        self.script("document.querySelector(arguments[0]).select()", f'[data-control="{name}"]')
        self.press(text or Keys.DELETE)
        time.sleep(0.5)  # longer than an entry waits for another key

    def put_back(self, before: dict[str, str]) -> None:
        """Enter what controls said, by their names, so that the next test finds the page as it began."""
        for name, text in before.items():
            self.enter(name, text)
        self.idle()

    def choose(self, label: str, text: str) -> None:
        from selenium.webdriver.common.keys import Keys

        find = "e.getAttribute('aria-label') == arguments[0]"
        lists = "[...document.querySelectorAll('[role=combobox]')]"
        self.script(f"{lists}.find(e => {find}).focus()", label)
        self.press(Keys.SPACE)
        choose = """const option = [...document.querySelectorAll('.q-menu [role=option]')]
            .find(e => e.innerText == arguments[0]); if (option) option.click(); return !!option"""
        wait(lambda: self.script(choose, text))
        wait(lambda: not self.script("return !!document.querySelector('.q-menu')"))

    def shows(self, name: str) -> bool:
        """Whether a control, such as "site.period", is visible."""
        visible = "return document.querySelector(arguments[0]).offsetParent !== null"
        return bool(self.script(visible, f'[data-slider="{name}"]'))

    def can_simulate(self) -> bool:
        """Whether the button that starts the simulation may be pressed."""
        return bool(self.script("return !document.querySelector('[data-simulate]').disabled"))

    def click(self, mark: str) -> None:
        self.driver.find_element("css selector", f"[data-{mark}]").click()

    def text(self, mark: str) -> str:
        text = "return document.querySelector(arguments[0]).textContent"
        return str(self.script(text, f"[data-{mark}]"))

    def value(self, name: str) -> str:
        value = "return document.querySelector(arguments[0]).value"
        return str(self.script(value, f'[data-control="{name}"]'))

    def curve(self, panel: str, number: int) -> list[float]:
        find = f"[data-panel={panel}] .chart"
        data = "const d = document.querySelector(arguments[0]).data[arguments[1]]; return [...d.y]"
        return list(self.script(data, find, number))

    def gaps(self) -> dict[str, float]:
        """The gap [cm] of each row of its chart, by its label; rows that share a line are waited out."""
        rows = """const d = document.querySelector('[data-panel=gaps] .chart').data;
            return d.filter(c => c.mode == 'markers+text')
              .flatMap(c => c.y.map((y, n) => [y, c.x[n]]))"""
        wait(lambda: len(dict(self.script(rows))) == len(self.script(rows)))
        return dict(self.script(rows))

    def send(self, *files: Path) -> None:
        """Choose these files to be opened."""
        entry = self.driver.find_element("css selector", "input[type=file]")
        entry.send_keys("\n".join(map(str, files)))

    def downloaded(self, name: str) -> Path:
        path = self.downloads / name
        wait(path.exists)
        return path.rename(path.with_stem(f"{path.stem} {time.monotonic_ns()}"))  # the next has its name
