"""``stochlin explore`` as its user meets it: the command, who may ask, the page in a browser."""

from __future__ import annotations

import http.client
import json
import socket
import sys
from typing import Any

import pytest
from browser import PATIENCE, wait
from cases import example_of_short_motion
from click.testing import CliRunner

from stochlin.applications.cases.examples import example_record
from stochlin.views.command import main

pytestmark = [pytest.mark.cli, pytest.mark.slow]  # in a browser


def run(*arguments: object) -> Any:
    return CliRunner().invoke(main, ["explore", "--no-open", *map(str, arguments)])


def test_a_port_that_cannot_be_used_is_refused():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        done = run("--port", taken.getsockname()[1])
    assert done.exit_code == 2
    assert "cannot be used" in done.output
    assert "give another --port" in done.output


def test_a_missing_extra_is_told_with_its_cure(monkeypatch):
    monkeypatch.delitem(sys.modules, "stochlin.views.explorer.server", raising=False)
    monkeypatch.setitem(sys.modules, "nicegui", None)
    done = run()
    assert done.exit_code == 1
    assert "pip install 'stochlin[app]'" in done.output


def response(address: str, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection(address, timeout=PATIENCE)
    try:
        connection.request("GET", path, headers=headers)
        return connection.getresponse()
    finally:
        connection.close()


PATHS = (
    "docs",
    "openapi.json",
    "redoc",
    "nothing",
    "a/b",
    "_nicegui/nothing",
    "_nicegui/3/static/x.js",
)


@pytest.mark.parametrize("path", ["", "favicon.ico", *PATHS])
def test_only_the_page_is_served_and_never_within_another(address, path):
    for headers in ({}, {"Host": "evil.example"}):
        answer = response(address, f"/{path}", **headers)
        assert answer.status == (403 if headers else 404 if path in PATHS else 200)
        assert answer.getheader("X-Frame-Options") == "DENY"
        assert answer.getheader("Content-Security-Policy") == "frame-ancestors 'none'"


def test_the_page_comes_from_this_machine_alone_and_has_an_answer(page, address):
    assert page.gap().startswith("Office block and Annex should stand 8.")
    assert page.script("return document.querySelectorAll('.answer svg').length") == 1
    assert "eq. (3) with a correlation coefficient" in page.text("answer")
    messages = [json.loads(e["message"])["message"] for e in page.driver.get_log("performance")]
    asked = [
        m["params"]["request"]["url"]
        for m in messages
        if m["method"] == "Network.requestWillBeSent"
    ]
    own = (f"http://{address}/", "data:", "chrome", "blob:")
    assert any(url.startswith(own[0]) for url in asked)
    assert [url for url in asked if not url.startswith(own)] == []


def test_a_slider_moved_by_keyboard_changes_entry_and_answer(page):
    from selenium.webdriver.common.keys import Keys

    before, slider = page.gap(), '[data-slider="building_1.reduction_factor"]'
    page.script("document.querySelector(arguments[0]).focus()", f"{slider} [tabindex]")
    page.press(Keys.ARROW_RIGHT)
    wait(lambda: page.value('entry="building_1.reduction_factor"') == "4.14")
    page.idle()
    wait(lambda: page.gap() != before)
    page.enter("building_1.reduction_factor", "4")
    assert page.gap() == before
    place = "return +document.querySelector(arguments[0]).getAttribute('aria-valuenow')"
    assert page.script(place, slider) == 0


def test_a_wrong_entry_shows_the_sentence_of_the_reader_beside_the_last_answer(page):
    before = page.gap()
    for text, message in (
        ("-1 s", "building_1.period = '-1 s' is out of range"),
        ("abc", "building_1.period = 'abc' is no number"),
        ("0.8", 'has no unit; allowed: a text with one of its units, "0.8 s"'),
        ("__import__('os').system('true')", "is no number"),
    ):
        page.enter("building_1.period", text)
        assert message in page.text("alert")
        assert "case.toml, line " in page.text("alert")
        assert page.gap() == before
    page.enter("building_1.period", "1.25 s")
    assert page.text("alert") == ""
    assert page.gap() != before


def test_what_is_saved_is_the_opened_file_with_another_line(page, tmp_path):
    path = tmp_path / "other.toml"
    record = '[[site.records]]\npath = "a.at2"\nname = "Record A"\n\n[motion]'
    text = (
        example_of_short_motion()
        .replace("[motion]", record)
        .replace('period = "0.6 s"', 'period = "0.8 s"')
    )
    text = text.replace('"Annex"', "'An\" onfocus=\"1'")
    path.write_text(text, encoding="utf-8")
    (tmp_path / "a.at2").write_text(example_record(), encoding="utf-8")
    page.send(path)
    wait(lambda: "choose the case file together with the files that it names" in page.text("alert"))
    page.send(path, tmp_path / "a.at2")
    wait(lambda: page.text("alert") == "")
    page.idle()
    assert page.value('entry="building_2.period"') == "0.8 s"
    label = "return document.querySelector(arguments[0]).getAttribute('aria-label')"
    said = page.script(label, '[data-entry="building_2.period"]')
    assert said == 'Building 2: An" onfocus="1: Period of small oscillations'
    page.enter("building_2.period", "0.75 s")
    page.click("save")
    saved = page.downloaded("other.toml").read_text(encoding="utf-8")
    assert saved == text.replace('period = "0.8 s"', 'period = "0.75 s"')
    page.send(tmp_path / "a.at2")
    wait(lambda: "0 case files are chosen; allowed: one" in page.text("alert"))
    assert page.value('entry="building_2.period"') == "0.75 s"
