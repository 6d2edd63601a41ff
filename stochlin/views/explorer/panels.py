"""A chart of the explorer with its words, also while it waits and where there is no chart."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from stochlin.views.explorer.pictures import Figure

COMPUTING = "Computing ..."
NO_AXES = {"xaxis": {"visible": False}, "yaxis": {"visible": False}}  # until there is something to draw


class Panel:
    """A chart with its words; while it waits it keeps the last values.

    Beside what it waits for stand the share that is done, if it is known, the seconds since the wait
    began, and a button that ends it.
    """

    def __init__(self, title: str, what: str, key: str, stop: Callable[[str], None]) -> None:
        self.table: xr.Dataset | None = None  # None while it shows nothing of the present values
        self.waiting, self._since = False, 0.0
        with ui.element("section").classes("panel").props(f"data-panel={key}"):
            with ui.element("h2"):
                ui.label(title)
            self.options = ui.element("div")
            self._state = ui.label().classes("state").props("role=status")
            with ui.element("div").classes("waits") as self._waits:
                self._bar = ui.element("progress").props(f'aria-label="Progress: {title}"')
                self._clock = ui.label()
                self._stop = ui.button("Stop", on_click=lambda: stop(key), color=None)
                self._stop.props(f'outline dense no-caps aria-label="Stop: {title}" data-stop={key}')
            self._chart = ui.plotly({"data": [], "layout": {"autosize": True, **NO_AXES}, "config": {}})
            self._chart.classes("chart").props(f'role=img aria-label="{what}"')
            self._words = ui.label().classes("about")
        self.wait()

    def wait(self) -> None:
        """The chart is behind the controls: the last one stays, pale."""
        self.table = None
        self._chart.classes("stale")
        self._await(True)

    def tell(self, why: str, share: float | None, stoppable: bool) -> None:
        """While it waits: for what, the share that is done, and whether this can be stopped."""
        self._state.text = why
        seconds = f"{time.monotonic() - self._since:.0f} s"
        self._clock.text = seconds if share is None else f"{share:.0%}, {seconds}"
        self._bar.props("value=0" if share is None else f"value={share:.2f}")
        self._bar.set_visibility(share is not None)
        self._stop.set_visibility(stoppable)

    def end(self, why: str) -> None:
        """Nothing is waited for any longer, and why."""
        self._await(False)
        self._state.text = why

    def show(self, table: xr.Dataset, figure: Figure, text: str, more: bool = False) -> None:
        """Show what was computed; whether ``more`` of it is still to come."""
        self.table = table
        self._await(more)
        height = figure["layout"].get("height")
        if height:
            self._chart.style(f"height: {height}px")
        self._chart.classes(remove="stale")
        self._chart.update_figure(figure)
        self._words.text = text

    def _await(self, waiting: bool) -> None:
        if waiting and not self.waiting:
            self._since = time.monotonic()
            self.tell(COMPUTING, None, False)
        if not waiting:
            self._state.text = ""
        self.waiting = waiting
        self._waits.set_visibility(waiting)
