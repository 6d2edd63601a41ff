"""One row of the form: a text with its slider, a list of words, or a switch."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from nicegui import ui

from stochlin.views.shared.symbols import typeset_html

if TYPE_CHECKING:
    from nicegui import events

    from stochlin.analyses.explorer.form import Choice, Entry

TYPING = 300  # ms after the last key, before a text is read
BETWEEN = 0.05  # s between two values of a slider that is dragged


class NativeSlider(ui.element, component="slider.js"):
    """A native slider."""

    def __init__(self, entry: Entry, slid: Callable[[float], None]) -> None:
        super().__init__()
        assert entry.key.slider is not None
        low, high, step, *_ = entry.key.slider
        self._props |= {"min": low, "max": high, "step": step, "start": entry.at}
        self.on("slide", lambda event: slid(float(event.args)), throttle=BETWEEN)


class EntryRow:
    """The row of a key. ``changed`` is called with the entry as it was and with another value."""

    def __init__(self, entry: Entry, group: str, changed: Callable[[Entry, Any], None]) -> None:
        self._entry, self._changed = entry, changed
        self._sliding = False
        self._slider: NativeSlider | None = None
        key, place = entry.key, f"{entry.table}.{entry.key.name}"
        name = f"{group}: {key.label}"  # with words of the user, and therefore no text of properties
        if type(key.kind) is tuple:  # of words; a quantity is a tuple with names
            words = dict.fromkeys([*key.kind, entry.value])
            _select([*words], key.label, entry.value, self._take).props(f'data-entry="{place}"')
            return
        with ui.element("div").classes("entry"):
            ui.html(typeset_html(key.label), sanitize=False).classes("name")
            if key.kind is bool:
                switch = ui.switch(
                    value=bool(entry.value), on_change=lambda event: self._take(event.value)
                )
                switch.props(f'dense data-entry="{place}"').props["aria-label"] = name
                return
            self._text = ui.input(value=entry.text, on_change=self._typed)
            self._text.props(f'dense outlined debounce={TYPING} autocomplete=off data-entry="{place}"')
            self._text.props["aria-label"] = name
            if entry.at is not None:
                self._slider = NativeSlider(entry, self._slid)
                self._slider.props(f'data-slider="{place}"').props["aria-label"] = f"{name}, slider"

    def _typed(self, event: events.ValueChangeEventArguments[Any]) -> None:
        self._take(self._entry.read(event.value or ""))
        if self._slider is not None and self._entry.at is not None and not self._sliding:
            self._slider.run_method("show", self._entry.at)  # it follows the text

    def _slid(self, at: float) -> None:
        self._sliding = True
        self._text.value = self._entry.slid(at)
        self._sliding = False

    def _take(self, value: Any) -> None:
        if value != self._entry.value:
            before, self._entry = self._entry, self._entry._replace(value=value)
            self._changed(before, value)


def choice_row(choice: Choice, chosen: Callable[[Choice, str], None]) -> None:
    """A list of the ways to describe a table."""
    select = _select([*choice.options], choice.label, choice.present, lambda way: chosen(choice, way))
    select.props(f'data-choice="{choice.table}"')


def _select(words: list[Any], label: str, present: Any, chosen: Callable[[Any], None]) -> ui.select:
    select = ui.select(words, label=label, value=present, on_change=lambda event: chosen(event.value))
    return select.props("dense outlined options-dense").classes("choice")
