"""What takes long: the page says what it waits for; nothing goes on for values that are gone."""

from __future__ import annotations

import os
import re
import signal
import time
from pathlib import Path

import pytest
from browser import wait

pytestmark = [
    pytest.mark.cli,
    pytest.mark.slow,  # in a browser
    pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="work is seen by /proc of Linux"),
]
STATE = "return document.querySelector('[data-panel=probability] .state')?.textContent || ''"
REST = 0.5  # s without work, after which a process rests


def work(server):
    """Processor time of the workers so far [s]."""
    children = Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text().split()
    stats = [Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split() for child in children]
    return sum(int(stat[11]) + int(stat[12]) for stat in stats) / os.sysconf("SC_CLK_TCK")


def rests_within(server, seconds):
    """Whether the workers do nothing after so many seconds."""
    time.sleep(seconds)
    before = work(server)
    time.sleep(REST)
    return work(server) - before < 0.1 * REST


def open_until_the_formula(chromium, address):
    chromium.driver.switch_to.new_window("tab")
    chromium.driver.get(f"http://{address}/")
    wait(lambda: "by formula" in chromium.script(STATE))


def leave(chromium):
    chromium.driver.close()
    chromium.driver.switch_to.window(chromium.driver.window_handles[0])


def test_what_takes_long_is_told_and_stops(chromium, tall):
    address, server = tall
    open_until_the_formula(chromium, address)
    panel = "[data-panel=probability]"
    waits = f"return document.querySelector('{panel} .waits').innerText"
    wait(lambda: re.match(r"[1-9]\d?%, \d+ s", chromium.script(waits)))
    assert "simulated by 128 motions" in chromium.text("panel=probability")
    assert "by formula," not in chromium.text("panel=probability")
    assert "Building 1, left: Tower" in chromium.script("return document.body.innerText")
    for other in ("spectra", "correlation", "gaps"):
        assert chromium.curve(other, 0), other
    chromium.click("stop=probability")
    wait(lambda: "Stopped. Another value" in chromium.script(STATE))
    assert rests_within(server, 1)
    for gap in range(9, 14):
        chromium.enter("separation.existing", str(gap))
    wait(lambda: "by formula" in chromium.script(STATE))
    leave(chromium)  # the tab is closed in the middle of the formula
    assert rests_within(server, 2)
    open_until_the_formula(chromium, address)
    start = time.monotonic()
    server.send_signal(signal.SIGINT)
    server.wait(10)
    assert time.monotonic() - start < 2
    leave(chromium)
