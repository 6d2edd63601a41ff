"""The explorer's page, served by a process of its own, in a browser."""

from __future__ import annotations

import shutil
from collections.abc import Iterator

import pytest
from browser import FLAGS, Browser, served
from cases import example_of_short_motion


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The page served by a process of its own, from the example case."""
    with served(tmp_path_factory.mktemp("explorer"), example_of_short_motion()) as (address, _):
        yield address


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
    """The page as it begins, of any width given; it must not have complained at the end."""
    chromium.open(address, getattr(request, "param", 1200))
    yield chromium
    complaints = [entry for entry in chromium.driver.get_log("browser") if entry["level"] != "INFO"]
    assert complaints == []
