"""One control on the page: a slider and an entry of the same number, a list, or a switch."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from stochlin.analyses.explorer.form import Choice, Form, NumberControl, Place
from stochlin.views.explorer.controls import (
    label_of,
    label_with_unit,
    name_of,
    read_entry,
    shown,
    text_of,
)
from stochlin.views.shared.symbols import typeset_html

PAUSE = 300  # ms after the last key, before an entry is read
BETWEEN = 0.05  # s between two values of a slider that is dragged

Changed = Callable[[Place, Any, str], None]
"""Told of a control's place and value; or of what is wrong with its entry."""


class NativeSlider(ui.element, component="slider.js"):
    """A native slider."""

    def __init__(self, number: NumberControl, start: float, slid: Callable[[float], None]) -> None:
        super().__init__()
        low, high, step, *_ = number.slider
        self._props |= {"min": low, "max": high, "step": step, "start": start}
        self.on("slide", lambda event: slid(float(event.args)), throttle=BETWEEN)

    def show(self, value: float) -> None:
        """Follow the entry."""
        self.run_method("show", value)


class NumberEntry:
    """A slider and a text of one number; errors are shown below them."""

    def __init__(self, number: NumberControl, group: str, form: Form, changed: Changed) -> None:
        self._number, self._changed = number, changed
        self._following = False  # whether the text is the slider's
        label, about = label_with_unit(number), number.slider.about
        self._name = name = f"{group}: {label}"
        of_page = name_of(number.place)
        with ui.element("div").classes("entry") as self.row:
            ui.html(typeset_html(label), sanitize=False).classes("name")
            self._text = ui.input(value=text_of(number, form), on_change=self._typed)
            hints = (
                f'dense outlined debounce={PAUSE} inputmode=decimal aria-label="{name}" autocomplete=off'
            )
            self._text.props(hints).props(f"data-control={of_page}")
            self._slider = NativeSlider(number, shown(number, form), self._slid)
            self._slider.props(f'aria-label="{name}, slider" data-slider={of_page}')
            if about:
                ui.label(about).classes("about").props(f"data-about={of_page}")
            self._message = ui.label().classes("wrong")
            self._message.set_visibility(False)

    def show(self, form: Form) -> None:
        """Follow the form, without telling of it."""
        self._following = True
        self._text.value = text_of(self._number, form)
        self._following = False
        self._slider.show(shown(self._number, form))
        self._tell("")

    def _typed(self) -> None:
        if self._following:
            return
        place, key = self._number.place, self._number.key
        try:
            value = read_entry(self._number, self._text.value)
        except ValueError as error:
            self._tell(f"{key.label} {error}")
            self._changed(place, None, f"{self._name} {error}.")
            return
        self._slider.show(value / key.unit_size)
        self._tell("")
        self._changed(place, value, "")

    def _slid(self, at: float) -> None:
        text = f"{at:.6g}"
        self._following = True
        self._text.value = text
        self._following = False
        self._tell("")
        self._changed(self._number.place, read_entry(self._number, text), "")

    def _tell(self, wrong: str) -> None:
        if wrong == self._message.text:
            return
        self._message.text = wrong
        self._message.set_visibility(bool(wrong))
        if wrong:
            self._text.classes("bad").props("aria-invalid=true")
        else:
            self._text.classes(remove="bad").props(remove="aria-invalid")


def choice_entry(choice: Choice, group: str, form: Form, changed: Changed) -> Any:
    """A list to choose from, or yes or no."""
    value = form[choice.place]
    with ui.element("div").classes("entry wide") as row:
        if choice.options:
            offered = {option: label_of(option) for option in form.options(choice)}
            entry: Any = ui.select(offered, label=choice.label, value=value)
            entry.props("outlined options-dense")
        else:
            entry = ui.switch(choice.label, value=value)
        name = name_of(choice.place)
        entry.props(f'dense aria-label="{group}: {choice.label}" data-control={name}')
        entry.on_value_change(lambda event: changed(choice.place, event.value, ""))
    return row
