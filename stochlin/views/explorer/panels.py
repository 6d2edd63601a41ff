"""A chart of the explorer with its words, also while it waits and where there is no chart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.views.explorer.pictures import Figure

COMPUTING = "Computing ..."


class Panel:
    """A chart with its words; while it waits it keeps the last values."""

    def __init__(self, title: str, what: str, key: str) -> None:
        self.table: xr.Dataset | None = None  # None while it shows nothing of the present values
        with ui.element("section").classes("panel").props(f"data-panel={key}"):
            with ui.element("h2"):
                ui.label(title)
            self.options = ui.element("div")
            self._state = ui.label(COMPUTING).classes("state").props("role=status")
            self._chart = ui.plotly({"data": [], "layout": {"autosize": True}, "config": {}})
            self._chart.classes("chart").props(f'role=img aria-label="{what}"')
            self._words = ui.label().classes("about")

    def wait(self, why: str = COMPUTING) -> None:
        """Say why the chart is behind the controls; the last chart stays, pale."""
        self.table = None
        self._state.text = why
        self._chart.classes("stale")

    def fail(self, why: str) -> None:
        """Say why these values have no chart."""
        self.wait(f"These values have no chart: {why}")

    def show(self, table: xr.Dataset, figure: Figure, text: str) -> None:
        """Show what was computed."""
        self.table = table
        self._state.text = ""
        height = figure["layout"].get("height")
        if height:
            self._chart.style(f"height: {height}px")
        self._chart.classes(remove="stale")
        self._chart.update_figure(figure)
        self._words.text = text
