"""One row of the form: a text with its slider, a switch, or a list of words."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from nicegui import ui

from stochlin.applications.cases.reading.kinds import TRUTH
from stochlin.applications.explorer.form import SLIDER_STEP
from stochlin.views.shared.blocks import typeset_html

if TYPE_CHECKING:
    from nicegui import events

    from stochlin.applications.explorer.form import FormEntry

TYPING = 300  # ms after the last key, before a text is read


class EntryRow:
    """The row of a key. ``changed`` is called with the entry and its other value."""

    def __init__(self, entry: FormEntry, group: str, changed: Callable[[FormEntry], None]) -> None:
        self._entry = entry
        self._changed = changed
        self._center = entry  # the value in the middle of the slider
        place = f"{entry.table}.{entry.name}"
        about = entry.key.about
        name = f"{group}: {about}"  # with words of the user, and therefore no text of properties
        with ui.element("div").classes("entry"):
            ui.html(typeset_html(about), sanitize=False).classes("name")
            if entry.key.kind is TRUTH:
                switch = ui.switch(value=bool(entry.value))
                switch.on_value_change(lambda event: self._take(event.value))
                switch.props(f'dense data-entry="{place}"').props["aria-label"] = name
                return
            if entry.words:
                select = ui.select([*entry.words], value=entry.value)
                select.on_value_change(lambda event: self._take(event.value))
                select.props(f'dense outlined options-dense data-choice="{place}"')
                select.props["aria-label"] = name
                return
            self._text = ui.input(value=entry.text, on_change=self._typed)
            self._text.props(
                f'dense outlined debounce={TYPING} autocomplete=off data-entry="{place}"'
            )
            self._text.props["aria-label"] = name
            self._slider = ui.slider(min=-1, max=1, step=SLIDER_STEP, value=0, on_change=self._slid)
            self._slider.props(f'data-slider="{place}"').props["aria-label"] = f"{name}, slider"
            self._reach()

    def _reach(self) -> None:
        """Put the slider in its middle."""
        reach = self._entry.reach()
        self._center = self._entry
        self._slider.set_visibility(reach is not None)
        self._slider.props["min"], self._slider.props["max"] = reach or (-1, 1)
        self._slider.value = 0

    def _typed(self, event: events.ValueChangeEventArguments[Any]) -> None:
        if (event.value or "") != self._entry.text:
            self._take(self._entry.read(event.value or ""))
            self._reach()

    def _slid(self, event: events.ValueChangeEventArguments[Any]) -> None:
        self._take(self._center.slid(event.value))
        self._text.value = self._entry.text

    def _take(self, value: Any) -> None:
        if value != self._entry.value:
            self._entry = self._entry._replace(value=value)
            self._changed(self._entry)
