"""The explorer's page, served by a process of its own, in a browser."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from browser import FLAGS, PATIENCE, PROGRAM, Browser, listens, wait
from tall_case import tower_and_annex

import stochlin as sl


@contextmanager
def served(folder: Path, case: str) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Address and process of a server of the page; at its end it must have said nothing else."""
    (folder / "case.toml").write_text(case, encoding="utf-8")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    # NiceGUI looks for this variable and would wait for a test runner of its own.
    environment = {name: text for name, text in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
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
    said = log.read_text().splitlines()
    assert said == [f"The explorer is at http://127.0.0.1:{port} (Ctrl+C ends it)"]


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The page served by a process of its own, from the example case."""
    with served(tmp_path_factory.mktemp("explorer"), sl.example_case()) as (address, _):
        yield address


@pytest.fixture
def tall(tmp_path: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Address and process of a server for buildings with many storeys in a long motion."""
    with served(tmp_path, tower_and_annex(duration=60, paths=128)) as server:
        yield server


@pytest.fixture(scope="session")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not (program and driver):
        pytest.skip("Chromium and chromedriver are not installed")
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    downloads = tmp_path_factory.mktemp("downloads")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(flag)
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        yield Browser(browser, downloads)
    finally:
        browser.quit()


@pytest.fixture
def page(chromium: Browser, address: str, request: pytest.FixtureRequest) -> Iterator[Browser]:
    """The page as it begins, of a width that may be given; it must not have complained at the end."""
    chromium.open(address, getattr(request, "param", 1200))
    yield chromium
    complaints = [entry for entry in chromium.driver.get_log("browser") if entry["level"] != "INFO"]
    assert complaints == []
