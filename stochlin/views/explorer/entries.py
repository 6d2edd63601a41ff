"""One control on the page: a slider and an entry of the same number, a list, or a switch."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from stochlin.analyses.explorer.scene import Scene
from stochlin.views.explorer.controls import SCALES, Choice, Control, label_of
from stochlin.views.shared.symbols import typeset_html

PAUSE = 300  # ms after the last key, before an entry is read
BETWEEN = 0.05  # s between two values of a slider that is dragged

Changed = Callable[[str, Any, str], None]
"""Told of a control's name and value; or of what is wrong with its entry."""


class Slider(ui.element, component="slider.js"):
    """A native slider."""

    def __init__(self, control: Control, start: float, slid: Callable[[float], None]) -> None:
        super().__init__()
        self._props |= {"min": control.low, "max": control.high, "step": control.step, "start": start}
        self.on("slide", lambda event: slid(float(event.args)), throttle=BETWEEN)

    def show(self, value: float) -> None:
        """Follow the entry."""
        self.run_method("show", value)


class NumberEntry:
    """A slider and a text of one number; errors are shown below them."""

    def __init__(self, control: Control, group: str, scene: Scene, changed: Changed) -> None:
        self._control, self._changed = control, changed
        self._following = False  # whether the text is the slider's
        self._name = name = f"{group}: {control.shown}"
        with ui.element("div").classes("entry") as self.row:
            ui.html(typeset_html(control.shown), sanitize=False).classes("name")
            self._text = ui.input(value=control.text(scene), on_change=self._typed)
            hints = (
                f'dense outlined debounce={PAUSE} inputmode=decimal aria-label="{name}" autocomplete=off'
            )
            self._text.props(hints).props(f"data-control={control.name}")
            value = getattr(scene, control.name) * SCALES.get(control.unit, 1.0)
            self._slider = Slider(control, value, self._slid)
            self._slider.props(f'aria-label="{name}, slider" data-slider={control.name}')
            if control.about:
                ui.label(control.about).classes("about").props(f"data-about={control.name}")
            self._message = ui.label().classes("wrong")
            self._message.set_visibility(False)

    def show(self, scene: Scene) -> None:
        """Follow the scene, without telling of it."""
        self._following = True
        self._text.value = self._control.text(scene)
        self._following = False
        self._slider.show(getattr(scene, self._control.name) * SCALES.get(self._control.unit, 1.0))
        self._tell("")

    def _typed(self) -> None:
        if self._following:
            return
        name = self._control.name
        try:
            value = self._control.read(self._text.value)
        except ValueError as error:
            self._tell(f"{self._control.label} {error}")
            self._changed(name, None, f"{self._name} {error}.")
            return
        self._slider.show(value * SCALES.get(self._control.unit, 1.0))
        self._tell("")
        self._changed(name, value, "")

    def _slid(self, place: float) -> None:
        text = f"{place:.6g}"
        self._following = True
        self._text.value = text
        self._following = False
        self._tell("")
        self._changed(self._control.name, self._control.read(text), "")

    def _tell(self, wrong: str) -> None:
        if wrong == self._message.text:
            return
        self._message.text = wrong
        self._message.set_visibility(bool(wrong))
        if wrong:
            self._text.classes("bad").props("aria-invalid=true")
        else:
            self._text.classes(remove="bad").props(remove="aria-invalid")


def choice_entry(choice: Choice, group: str, scene: Scene, changed: Changed) -> Any:
    """A list to choose from, or yes or no."""
    value = getattr(scene, choice.name)
    with ui.element("div").classes("entry wide") as row:
        if choice.options:
            offered = {option: label_of(option) for option in choice.offered(scene)}
            entry: Any = ui.select(offered, label=choice.label, value=value)
            entry.props("outlined options-dense")
        else:
            entry = ui.switch(choice.label, value=value)
        entry.props(f'dense aria-label="{group}: {choice.label}" data-control={choice.name}')
        entry.on_value_change(lambda event: changed(choice.name, event.value, ""))
    return row
