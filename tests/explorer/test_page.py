"""``stochlin explore`` as its user meets it: the command, who may ask, and the page in a browser."""

from __future__ import annotations

import http.client
import json
import re
import socket
import sys
import time
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr
from browser import PATIENCE, wait
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.command import main
from stochlin.views.explorer.server import OwnOrigin, names_of
from stochlin.views.explorer.workers import PROBABILITY, Worker

pytestmark = [pytest.mark.cli, pytest.mark.slow]  # in a browser


def run(*arguments: object) -> Any:
    return CliRunner().invoke(main, ["explore", "--no-open", *map(str, arguments)])


def test_a_port_in_use_is_told():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = run("--port", port)
    assert done.exit_code == 2
    assert f"--host 127.0.0.1 --port {port} cannot be used" in done.output
    assert "give another --port" in done.output


def test_an_unknown_host_is_told():
    done = run("--host", "192.0.2.1")  # of no machine, RFC 5737
    assert done.exit_code == 2
    assert "--host 192.0.2.1" in done.output


def test_a_missing_extra_is_told_with_its_cure(monkeypatch):
    monkeypatch.delitem(sys.modules, "stochlin.views.explorer.server", raising=False)
    monkeypatch.setitem(sys.modules, "nicegui", None)
    done = run()
    assert done.exit_code == 1
    assert "pip install 'stochlin[app]'" in done.output


def test_a_bad_case_file_is_told(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(sl.example_case().replace('period = "1.0 s"', 'period = "40 s"'), encoding="utf-8")
    done = run("--case", path)
    assert done.exit_code == 2
    assert (
        "building_1.period = '40 s' is out of range in the explorer; allowed: 0.02 <= value <= 20"
        in done.output
    )
    assert "there is no such file" in run("--case", tmp_path / "none.toml").output


@pytest.mark.parametrize(
    ("listens", "host", "origin", "allowed"),
    [
        ("127.0.0.1", "127.0.0.1:8640", "", True),
        ("127.0.0.1", "localhost:8640", "http://localhost:8640", True),
        ("127.0.0.1", "127.0.0.1:8640", "http://127.0.0.1:9999", False),
        ("127.0.0.1", "127.0.0.1:8640", "http://evil.example", False),
        ("127.0.0.1", "evil.example:8640", "http://evil.example:8640", False),
        ("127.0.0.1", "127.0.0.1:8640", "null", False),
        ("127.0.0.1", "", "", False),
        ("127.0.0.1", "[", "", False),
        ("127.0.0.1", "127.0.0.1:8640", "http://[bad", False),
        ("0.0.0.0", "any.name:8640", "http://[bad", False),
        ("::1", "[::1]:8640", "http://[::1]:8640", True),
        ("localhost", "127.0.0.1:8640", "", True),
        ("192.168.1.5", "192.168.1.5:8640", "http://192.168.1.5:8640", True),
        ("192.168.1.5", "localhost:8640", "", False),
        ("0.0.0.0", "any.name:8640", "http://any.name:8640", True),
        ("0.0.0.0", "any.name:8640", "http://evil.example", False),
    ],
)
def test_only_its_own_pages_may_ask(listens, host, origin, allowed):
    headers = {b"host": host.encode()} | ({b"origin": origin.encode()} if origin else {})
    assert OwnOrigin(None, names_of(listens)).allows(headers) is allowed


def test_a_page_that_asks_while_the_server_ends_is_answered_by_a_cancelled_question():
    worker = Worker()
    worker.close()
    assert worker.ask(PROBABILITY, {}).answer.cancelled()


def response(address: str, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection(address, timeout=PATIENCE)
    try:
        connection.request("GET", path, headers=headers)
        return connection.getresponse()
    finally:
        connection.close()


def status(address: str, path: str, **headers: str) -> int:
    return response(address, path, **headers).status


PATHS = ("docs", "openapi.json", "redoc", "nothing", "a/b", "_nicegui/nothing", "_nicegui/3/static/x.js")


@pytest.mark.parametrize("path", ["", "favicon.ico", *PATHS])
def test_only_the_page_is_served_and_never_within_another(address, path):
    for headers in ({}, {"Host": "evil.example"}):
        answer = response(address, f"/{path}", **headers)
        assert answer.status == (403 if headers else 404 if path in PATHS else 200)
        assert answer.getheader("X-Frame-Options") == "DENY"
        assert answer.getheader("Content-Security-Policy") == "frame-ancestors 'none'"


def test_requests_of_other_hosts_and_pages_are_refused(address):
    assert status(address, "/") == 200
    assert status(address, "/", Host="evil.example") == 403
    upgrade = {
        "Connection": "Upgrade",
        "Upgrade": "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    }
    channel = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
    assert status(address, channel, **upgrade, Origin=f"http://{address}") == 101
    assert status(address, channel, **upgrade, Origin="http://evil.example") == 403


def test_the_page_comes_from_this_machine_alone(page, address):
    assert page.text("told").startswith("Press Simulate to run")
    assert "linearization alone is unsafe" in page.text("caution")
    assert page.script("return document.body.innerText").count("Caution") == 1
    messages = [json.loads(e["message"])["message"] for e in page.driver.get_log("performance")]
    asked = [
        m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"
    ]
    own = [url for url in asked if url.startswith(f"http://{address}/")]
    others = [
        url for url in asked if not url.startswith((f"http://{address}/", "data:", "chrome", "blob:"))
    ]
    assert own
    assert others == []


def test_a_slider_moved_by_keyboard_moves_the_curves(page, capsys):
    from selenium.webdriver.common.keys import Keys

    before = {panel: page.curve(panel, 0) for panel in ("correlation", "gaps", "probability")}
    page.script(
        """window.drawn = {};
        for (const p of ['spectra', 'correlation', 'gaps']) document
          .querySelector(`[data-panel=${p}] .chart`)
          .on('plotly_afterplot', () => window.drawn[p] ??= performance.now() - window.pressed);
        document.addEventListener('keydown', () => window.pressed ??= performance.now(), true);
        document.querySelector('[data-slider="building_1.reduction_factor"]').focus()"""
    )
    page.press(Keys.ARROW_RIGHT)
    wait(lambda: len(page.script("return Object.keys(window.drawn)")) == 3)
    drawn = page.script("return window.drawn")
    times = [f"{name} {ms:.0f} ms" for name, ms in drawn.items()]
    with capsys.disabled():
        sys.stdout.write(f"\nDrawn after a key on a slider: {', '.join(times)}\n")
    assert max(drawn.values()) < 5000
    assert page.value("building_1.reduction_factor") == "4.1"
    page.idle()
    for panel in ("correlation", "probability"):
        assert page.curve(panel, 0) != before[panel], panel
    page.enter("building_1.reduction_factor", "4")
    wait(lambda: page.curve("correlation", 0) == before["correlation"])
    slider = """document.querySelector('[data-slider="building_1.reduction_factor"]')"""
    assert page.script(f"return {slider}.value") == "4"
    page.idle()


def test_bad_entries_are_told_and_charts_keep_the_last_values(page):
    before = page.curve("correlation", 0)
    for text in ("-1", "abc", "1e999", "__import__('os').system('true')"):
        page.enter("building_1.period", text)
        wait(lambda text=text: text.lstrip("_") in page.text("alert"))
        assert "Building 1, left: Period [s]" in page.text("alert")
        assert "allowed: 0.02 <= value <= 20" in page.text("alert")
        assert page.curve("correlation", 0) == before
    page.enter("building_1.period", "1.25")
    wait(lambda: page.text("alert") == "")
    wait(lambda: page.curve("correlation", 0) != before)
    page.enter("motion.rise_end", "18")  # by itself it would do
    wait(lambda: "strong_end >= rise_end" in page.text("alert"))
    page.enter("motion.rise_end", "4")
    wait(lambda: page.text("alert") == "")
    page.enter("building_1.period", "1")
    wait(lambda: page.curve("correlation", 0) == before)
    page.idle()


def test_every_control_is_reached_by_tab_and_has_a_name(page):
    from selenium.webdriver.common.keys import Keys

    shown = """return [...document.querySelectorAll('input, button, summary, [role=switch]')]
        .filter(e => e.offsetParent && !e.closest('[aria-hidden=true]')).length"""
    page.script("document.querySelector('.skip').focus()")
    names: list[str] = []
    described = """const e = document.activeElement, l = e.labels && e.labels[0];
        return e === document.body ? null
          : e.getAttribute('aria-label') || (l ? l.innerText : '') || e.innerText || '?' + e.outerHTML"""
    while (name := page.script(described)) is not None and len(names) < 200:
        names.append(name)
        page.press(Keys.TAB)
    assert not [name for name in names if name.startswith("?")]
    assert len(names) == page.script(shown) + 1  # the link to the charts, too
    assert len(set(names)) == len(names)
    assert "Building 2, right: Period [s], slider" in names
    assert "Simulate" in names


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_are_readable_in_both_colour_schemes(page, scheme):
    prefer(page, scheme)
    try:
        seen = page.script(
            """const opaque = e => { const c = getComputedStyle(e).backgroundColor;
                 return c == 'rgba(0, 0, 0, 0)' && e.parentElement ? opaque(e.parentElement) : c };
               return [...document.querySelectorAll('.name, .about, .why, .caution, h1, h2, summary')]
                 .concat([...document.querySelectorAll('.head div, .q-btn--outline, .q-field__native')])
                 .filter(e => e.offsetParent)
                 .map(e => [e.className, getComputedStyle(e).color, opaque(e)])"""
        )
    finally:
        prefer(page, "light")
    assert seen
    for name, *colours in seen:
        light, faint = sorted(map(luminance, colours), reverse=True)
        assert (light + 0.05) / (faint + 0.05) >= 4.5, (name, colours)


def prefer(page, scheme):
    """The page follows what the browser prefers."""
    wanted = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", wanted)
    wait(lambda: page.script("return document.body.classList.contains(arguments[0])", f"body--{scheme}"))


def luminance(colour: str) -> float:
    """Of WCAG 2."""
    values = np.array([float(share) for share in re.findall(r"[\d.]+", colour)[:3]]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("page", [1200, 768, 390], indirect=True)
def test_nothing_is_wider_than_the_screen(page):
    """Also with all groups of controls open."""
    needed, wide = page.script(
        """const shut = [...document.querySelectorAll('details:not([open])')];
        shut.forEach(d => d.open = true);
        const wide = [...document.querySelectorAll('.chart, .entry, .words, .panel')]
          .filter(e => e.getBoundingClientRect().right > arguments[0]).length;
        const needed = document.documentElement.scrollWidth;
        shut.forEach(d => d.open = false);
        return [needed, wide]""",
        page.width,
    )
    assert needed <= page.width
    assert wide == 0


TICKS = """return [...document.querySelectorAll('.chart')].map(c =>
  ['.xtick', '.ytick', '.y2tick'].map(t => [...c.querySelectorAll(t + ' text')].map(e => {
    const r = e.getBoundingClientRect();
    return [e.textContent, r.left, r.right, r.top, r.bottom] })))"""
TITLES = "return [...document.querySelectorAll('.xtitle, .ytitle, .y2title')].map(e => e.textContent)"


@pytest.mark.parametrize("page", [390, 1200], indirect=True)
def test_ticks_are_few_round_numbers_apart_from_one_another(page):
    apart(page)
    own = page.value("site.intensity")
    for intensity in ("0.00003", "0.05", own) if page.width > 1000 else ():
        before = page.curve("spectra", 0)
        page.enter("site.intensity", intensity)
        wait(lambda before=before: page.curve("spectra", 0) != before)
        page.idle()
        apart(page)


def apart(page):
    spectra, correlation, gaps, probability = page.script(TICKS)
    for x, y, y2 in (spectra, correlation, (gaps[0], [], []), probability):
        for axis, first in ((x, 1), (y, 3), (y2, 3)):
            assert len(axis) <= 8
            for text, *_ in axis:
                assert re.fullmatch("[\N{MINUS SIGN}-]?[0-9]{1,5}(\\.[0-9]{1,3})?", text), text
            ends = sorted((place[first], place[first + 1]) for place in axis)
            assert all(left[1] <= right[0] for left, right in pairwise(ends)), axis
    titles = page.script(TITLES)
    assert {"period T [s]", "PSD [cm²/s³]", "PSD [cm² s]", "gap [cm]", "time [s]"} <= {*titles}
    raised = "return [...document.querySelectorAll('.chart .xtitle tspan')].map(e => e.textContent)"
    assert {"1", "2"} <= {*page.script(raised)}  # the indices of T2/T1


def test_simulation_is_drawn_when_it_is_asked_for_and_forgotten_when_it_is_old(page):
    curves = "return document.querySelector('[data-panel=correlation] .chart').data.length"
    before = {name: page.value(name) for name in ("separation.existing", "simulation.paths")}
    page.enter("simulation.paths", "128")
    wait(page.can_simulate)
    page.idle()
    assert page.script(curves) == 3
    page.click("simulate")
    wait(lambda: page.text("told").startswith("Simulated: 128 motions"))
    page.idle()
    assert page.script(curves) == 4
    assert "Simulated:" in page.text("panel=gaps")
    lines = "return document.querySelectorAll('[data-panel=gaps] .ytick text').length"
    assert page.script(lines) == 8
    page.click("every")
    wait(lambda: page.script(lines) > 30)
    page.enter("separation.existing", "9")
    wait(lambda: page.script(curves) == 3)
    page.idle()
    assert page.text("told").startswith("Press Simulate to run")
    page.click("every")
    page.put_back(before)


def test_a_simulation_can_be_stopped(page):
    before = {name: page.value(name) for name in ("building_2.period", "simulation.paths")}
    page.enter("simulation.paths", "20000")
    page.idle()
    page.click("simulate")
    wait(lambda: float(page.script("return document.querySelector('progress').value")) > 0)
    page.enter("building_2.period", "0.7")  # the page answers meanwhile
    wait(lambda: page.text("told").startswith(("Stopped", "These values are not")))
    wait(page.can_simulate)
    page.put_back(before)


def test_what_is_saved_can_be_read(page):
    before = {name: page.value(name) for name in ("building_2.period", "separation.existing")}
    page.enter("building_2.period", "0.77")
    page.enter("separation.existing", "7.5")
    wait(lambda: page.text("alert") == "")
    page.idle()
    page.click("save-case")
    case = sl.read_case(page.downloaded("case.toml"))
    assert (case.second.structure.period, case.gap) == (0.77, 0.075)
    assert (case.title, case.first.height) == ("Office block and annex", 24)
    page.click("save-data")
    with xr.open_dataset(page.downloaded("explored.nc"), engine="scipy") as table:
        assert table.attrs["gap_m"] == 0.075
        rho = table.correlation_rho_drift.values.tolist()
        assert "probability_confidence_of_no_pounding" in table
    assert page.curve("correlation", 0) == rho
    page.put_back(before)


def test_a_building_becomes_one_with_storeys_and_an_oscillator_again(page):
    of_oscillator, of_storeys = "building_1.reduction_factor", "building_1.base_shear_coefficient"
    assert page.shows(of_oscillator)
    assert not page.shows(of_storeys)
    page.choose("Building 1 described as", "regular storeys")
    wait(lambda: page.shows(of_storeys) and not page.shows(of_oscillator))
    assert page.value("building_1.storeys") == "8"  # as the file says of the oscillator
    assert page.value("building_1.storey_height") == "3"
    page.enter("building_1.storeys", "4")  # with fewer storeys and motions it is quick
    page.enter("simulation.paths", "128")
    page.idle()
    assert "no map of its bias for storeys" in page.text("caution")
    assert "lower roof" in page.text("panel=correlation")
    assert "simulated by 128 motions (" in page.text("panel=probability")
    before = page.curve("spectra", 1), page.curve("gaps", 0), page.curve("probability", 2)
    page.enter("building_1.storeys", "2.5")
    wait(lambda: "allowed: a whole number from 1 to 60" in page.text("alert"))
    assert page.curve("spectra", 1) == before[0]
    page.enter("building_1.storeys", "3")
    page.choose("Building 2 described as", "regular storeys")
    wait(lambda: page.shows("building_2.storeys"))
    wait(lambda: "Floors are not level" not in page.text("panel=gaps"))
    assert page.value("building_2.storeys") == "5"
    page.enter("building_2.storeys", "2")
    page.idle()
    assert page.curve("spectra", 1) != before[0]
    assert "It is needed at" in page.text("panel=gaps")
    page.enter("building_2.storey_height", "3.5")
    wait(lambda: "Floors are not level: floor 1 of Office block" in page.text("panel=gaps"))
    page.idle()
    page.enter("separation.existing", "11")
    page.idle()
    page.click("save-case")
    case = sl.read_case(page.downloaded("case.toml"))
    assert (case.gap, case.floors_align) == (0.11, False)
    assert "floors_align = false, since floor 1 of Office block" in page.text("told")
    assert [building.structure.storeys for building in case.buildings] == [3, 2]
    np.testing.assert_allclose(case.second.structure.heights, 3.5)
    page.choose("Building 1 described as", "oscillator")
    page.choose("Building 2 described as", "oscillator")
    wait(lambda: page.shows(of_oscillator))
    page.idle()
    assert "bias" not in page.text("caution").replace("the map of its bias", "")


def test_another_ground_has_other_controls(page):
    assert not page.shows("site.period")
    page.choose("Kind of ground", "Kanai-Tajimi filter")
    wait(lambda: page.shows("site.period"))
    page.idle()
    assert re.search("too small for building 1", page.text("caution"))
    page.choose("Kind of ground", "firm ground")
    wait(lambda: not page.shows("site.period"))
    page.idle()


def test_a_ground_by_a_spectrum_or_a_peak_is_sought_beside_the_page(page, capsys):
    before = page.curve("spectra", 0)
    page.choose("Strength given by", "peak ground acceleration")
    wait(lambda: page.shows("site.pga") and not page.shows("site.intensity"))
    wait(lambda: page.curve("spectra", 0) != before)
    page.idle()
    middle = page.curve("spectra", 0)
    page.enter("site.pga", "0.6")  # twice as strong: four times the spectrum
    wait(lambda: page.curve("spectra", 0) != middle)
    page.idle()
    np.testing.assert_allclose(page.curve("spectra", 0), 4 * np.array(middle), rtol=1e-9)
    page.choose("Kind of ground", "Eurocode 8 spectrum")
    wait(lambda: page.shows("site.ag") and not page.shows("site.pga"))
    wait(lambda: "Finding the ground" in page.text("panel=spectra"))
    start = time.monotonic()
    page.enter("separation.existing", "9")  # the page answers meanwhile
    page.idle()
    with capsys.disabled():
        sys.stdout.write(f"\nFitted to a spectrum in {time.monotonic() - start:.1f} s\n")
    assert page.can_simulate()
    page.enter("site.ag", "0.35")
    page.idle()
    page.click("save-case")
    text = page.downloaded("case.toml").read_text(encoding="utf-8")
    assert 'spectrum = "eurocode_8"' in text
    assert 'existing = "9 cm"' in text
    page.choose("Kind of ground", "white noise")
    wait(lambda: "white noise has no peak" in page.text("panel=spectra"))
    page.choose("Kind of ground", "firm ground")
    page.idle()
