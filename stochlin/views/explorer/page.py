"""The explorer's page: controls beside charts, each of which is updated as fast as possible."""

from __future__ import annotations

import asyncio
import dataclasses
import logging
from concurrent.futures import ThreadPoolExecutor
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from stochlin.analyses.explorer import formulas as exploration
from stochlin.analyses.explorer.case_text import case_text, files_named, left_out
from stochlin.analyses.explorer.simulations import merge_tables
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.models.systems import floor_count
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import GROUPS, Control, counts
from stochlin.views.explorer.entries import NumberEntry, choice_entry
from stochlin.views.explorer.panels import Panel
from stochlin.views.explorer.workers import (
    CORRELATION,
    GAPS,
    GROUND,
    OPEN,
    PROBABILITY,
    RECORDS,
    SIMULATIONS,
    SPECTRA,
    Stopped,
)
from stochlin.views.shared.words import columns_hit

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import xarray as xr
    from nicegui import events

    from stochlin.analyses.explorer.scene import Scene
    from stochlin.views.explorer.workers import Job, Worker

REFUSED = (ValueError, ArithmeticError, MemoryError, OSError)
PANELS = {
    SPECTRA: ("Spectra", "Power spectral densities of ground and displacements over period"),
    CORRELATION: ("Correlation", "Correlation coefficient over the ratio of the periods"),
    GAPS: ("Required gap by rule", "Required gap by rule, beside the existing gap"),
    PROBABILITY: ("No pounding up to each time", "Probability of no pounding over time"),
}
FOLD = "if (innerWidth < 720) document.querySelectorAll('details').forEach(d => d.open = false)"
KEPT = "The charts keep the last values."
LOG = logging.getLogger("stochlin")
FORMULAS: dict[str, Callable[[Scene], xr.Dataset]] = {
    CORRELATION: exploration.correlation,
    SPECTRA: exploration.spectra,
    GAPS: exploration.gap_rules,
}
PATIENT = (SPECTRA, GAPS, PROBABILITY, CORRELATION)  # in this order, what is not there at once
FEW_STOREYS = 24  # of both buildings, with which spectra and gaps are there at once
MOST_BYTES = 64 * 2**20  # of a case file with its records
LOOK = 0.2  # s between two looks at how far a simulation is
# One thread for all pages: numpy's work between Python's steps gains nothing from more.
_FAST = ThreadPoolExecutor(1, thread_name_prefix="explorer")


class Page:
    """One browser's view of a scene."""

    def __init__(self, scene: Scene, notes: list[str], patient: Worker, simulator: Worker) -> None:
        # What the controls say, and the last of it whose ground is known: that is what is shown.
        self._wanted = self._scene = scene
        self._patient, self._simulator = patient, simulator
        self._values: dict[str, Any] = vars(scene).copy()
        self._wrong: dict[str, str] = {}  # messages of entries that cannot be read
        self._rows: dict[str, Any] = {}
        self._entries: dict[str, NumberEntry] = {}
        self._fast, self._slow = False, False  # whether a round is under way
        self._seeking = False  # whether a ground is sought
        self._job: Job | None = None
        self._patience: Job | None = None  # the last that was asked of the patient one
        self._simulated: Mapping[str, xr.Dataset] = {}
        self._recorded: tuple[Scene, xr.Dataset] | None = None  # gaps of records, and of what values
        self._closed = False
        self._build(notes)
        ui.context.client.on_delete(self._leave)
        ui.timer(0, self._begin, once=True)

    async def _begin(self) -> None:
        await ui.context.client.connected()
        ui.run_javascript(FOLD)
        await self._refresh()

    def _build(self, notes: list[str]) -> None:
        ui.colors(primary="#2166ac")
        ui.dark_mode(None)  # as the browser prefers
        ui.link("To the charts", "#charts").classes("skip")
        with ui.element("header").classes("head"):
            with ui.element("h1"):
                self._title = ui.label()
            ui.label("How far must two buildings on the same ground stand apart?")
        with ui.element("main").classes("sheet"):
            self._form = ui.element("form").classes("controls").props('onsubmit="return false"')
            with ui.element("div").props("id=charts tabindex=-1"):
                self._words()
                with ui.element("div").classes("charts"):
                    self._panels = {key: Panel(*texts, key) for key, texts in PANELS.items()}
        with self._panels[GAPS].options:
            self._every = ui.switch("Every rule on a line of its own", on_change=self._draw_gaps)
            self._every.props("dense data-every")
        self._show_controls(notes)

    def _show_controls(self, notes: list[str]) -> None:
        """All that is of the present file: its title, its notes, and controls with its values."""
        self._title.text = self._scene.title
        self._notes.clear()
        with self._notes:
            for note in notes:
                ui.label(note)
        self._form.clear()
        with self._form:
            for group in GROUPS:
                self._group(group.title, group.controls)
        self._hide()

    def _group(self, title: str, controls: Any) -> None:
        with ui.element("details").props("open"):
            with ui.element("summary"):
                ui.label(title).style("display: inline")
            for control in controls:
                if isinstance(control, Control):
                    entry = NumberEntry(control, title, self._scene, self._change)
                    self._entries[control.name], row = entry, entry.row
                else:
                    row = choice_entry(control, title, self._scene, self._change)
                self._rows[control.name] = row

    def _words(self) -> None:
        with ui.element("div").classes("words"):
            self._notes = ui.element("div").props("data-notes")
            self._alert = ui.label().classes("wrong").props("role=alert data-alert")
            self._caution = ui.label().classes("caution").props("role=status data-caution")
            self._why = ui.label().classes("why")
            with ui.element("div").classes("buttons"):
                self._start = _button("Simulate", self._simulate, "data-simulate")
                self._stop = _button("Stop", self._interrupt, "outline data-stop")
                self._bar = ui.element("progress").props('max=1 value=0 aria-label="Simulation"')
                files = ui.upload(on_multi_upload=self._open, multiple=True, auto_upload=True)
                files.props(f"max-total-size={MOST_BYTES}").classes("files")
                files.on("rejected", self._too_large)
                self._files = files
                pick = f"() => getElement({files.id}).pickFiles()"
                _button("Open case file", None, "outline data-open").on("click", js_handler=pick)
                _button("Save case file", self._save_case, "outline data-save-case")
                _button("Save dataset", self._save_data, "outline data-save-data")
            self._told = ui.label(words.START).props("role=status data-told")
        self._running(False)

    def _change(self, name: str, value: Any, wrong: str) -> None:
        """Take another value of a control; if it is not valid, the charts keep the last values."""
        self._wrong.pop(name, None)
        if wrong:
            self._wrong[name] = wrong
        else:
            self._values[name] = value
            if name.startswith("strength_by"):
                self._keep_strength(int(name[-1]))
            self._hide()
        messages = list(self._wrong.values())
        if not messages:
            try:
                shown = {name: self._values[name] for name in self._rows}
                scene = dataclasses.replace(self._wanted, **shown)
            except (ValueError, TypeError) as error:
                messages = [f"These values do not fit: {error}."]
        self._alert.text = " ".join([*messages, KEPT] if messages else [])
        if not messages and scene != self._wanted:
            self._take(scene)

    def _take(self, scene: Scene) -> None:
        """Other values, of which nothing is simulated."""
        self._wanted = scene
        self._interrupt()
        self._drop()  # at once: the next round may begin before the refresh
        self._simulated = {}
        self._told.text = words.START
        background_tasks.create(self._refresh())

    def _keep_strength(self, number: int) -> None:
        """Start the other way to give the strength of an oscillator with the strength that it has."""
        try:
            name, value = self._scene.equivalent_strength(number)
            changed: dict[str, Any] = {name: value}
            shown = dataclasses.replace(self._scene, **changed)
        except REFUSED:  # elastic, or beyond what may be entered: the control starts as it stands
            return
        self._values[name] = value
        self._entries[name].show(shown)

    async def _open(self, event: events.MultiUploadEventArguments) -> None:
        """Show another case file; one that cannot be read changes nothing."""
        files = {PurePath(file.name).name: await file.read() for file in event.files}
        self._files.reset()
        self._told.text = "Opening the case file ..."
        try:
            scene, notes = await asyncio.wrap_future(self._patient.ask(OPEN, files).answer)
        except (Stopped, asyncio.CancelledError):
            return
        except Exception as error:
            self._told.text = ""
            self._alert.text = f"The file was not opened: {_why(error, OPEN, self._scene)}"
            return
        self._scene, self._values, self._wrong = scene, vars(scene).copy(), {}
        self._alert.text = ""
        self._show_controls(notes)
        ui.run_javascript(FOLD)
        self._take(scene)

    def _hide(self) -> None:
        for name, row in self._rows.items():
            row.set_visibility(counts(name, self._values))

    async def _refresh(self) -> None:
        """Start the rounds that are not under way: those that are go on to the latest values."""
        if not await self._seek():
            return
        for key in set(PATIENT).difference(_at_once(self._scene)):
            self._panels[key].wait()
        await self._fast_round()  # first, for both want the processor
        await self._slow_round()

    async def _seek(self) -> bool:
        """Whether the ground of the present values is known, after a fit or a simulation if needed."""
        if self._seeking:
            return False
        self._seeking = True
        while not (self._wanted.settled or self._over):
            for panel in self._panels.values():
                panel.wait(words.SEEKING)
            self._running(self._job is not None)
            asked = self._wanted
            self._patience = self._patient.ask(GROUND, asked)
            try:
                found: Scene = await asyncio.wrap_future(self._patience.answer)
            except (Stopped, asyncio.CancelledError):  # for the sake of other values
                continue
            except Exception as error:
                if asked is self._wanted:
                    for panel in self._panels.values():
                        panel.fail(_why(error, GROUND, asked))
                    break
                continue
            self._wanted = dataclasses.replace(
                self._wanted, fitted=found.fitted, measured=found.measured
            )
        self._seeking = False
        if self._wanted.settled:
            self._scene = self._wanted
        self._running(self._job is not None)
        return self._wanted.settled

    async def _fast_round(self) -> None:
        if self._fast:
            return
        self._fast, done = True, None
        loop = asyncio.get_running_loop()
        while done is not self._scene and not self._over:
            done = scene = self._scene
            for key in _at_once(scene):
                await self._answer(key, scene, loop.run_in_executor(_FAST, FORMULAS[key], scene))
        self._fast = False

    async def _slow_round(self) -> None:
        if self._slow or self._fast:
            return
        self._slow, done = True, None
        while done is not self._scene and not self._over:
            done = scene = self._scene
            for key in PATIENT:
                if key not in _at_once(scene) and scene is self._scene:
                    self._patience = self._patient.ask(key, scene)
                    await self._answer(key, scene, asyncio.wrap_future(self._patience.answer))
            if scene is self._scene:
                await self._run_records(scene)
        self._slow = False

    async def _run_records(self, scene: Scene) -> None:
        """Show the gaps that the records of the file need, beside those already shown."""
        if not scene.records:
            return
        self._patience = self._patient.ask(RECORDS, scene)
        try:
            self._recorded = scene, await asyncio.wrap_future(self._patience.answer)
        except (Stopped, asyncio.CancelledError):
            return
        except Exception as error:
            self._told.text = f"The records were not evaluated: {_why(error, RECORDS, scene)}"
            return
        shown = self._panels[GAPS].table
        if shown is not None and scene is self._wanted and not self._over:
            self._draw(GAPS, shown, scene)

    async def _answer(self, key: str, scene: Scene, answer: asyncio.Future[xr.Dataset]) -> None:
        """Draw an answer, or say why there is none; no error ends a round."""
        try:
            table = await answer
            if not self._over:
                self._draw(key, table, scene)
                if scene is not self._wanted:
                    self._panels[key].wait()
        except (Stopped, asyncio.CancelledError):  # for the sake of other values
            self._panels[key].wait()
        except Exception as error:
            self._panels[key].fail(_why(error, key, scene))

    def _draw(self, key: str, table: xr.Dataset, scene: Scene) -> None:
        """Draw a formula's table, beside it the simulation of the present values if there is one."""
        simulated = self._simulated.get(key) if scene is self._scene else None
        panel = self._panels[key]
        if key == SPECTRA:
            if scene.has_storeys:
                self._caution.text, self._why.text = words.caution_of_storeys(scene)
            periods = scene.period_1, scene.period_2
            panel.show(table, charts.spectra_figure(table, periods), words.spectra(table))
        elif key == CORRELATION:
            if not scene.has_storeys:
                self._caution.text, self._why.text = words.caution(table)
            panel.show(table, charts.correlation_figure(table, simulated), words.correlation(table))
        elif key == GAPS:
            every = bool(self._every.value)
            own = self._recorded is not None and self._recorded[0] is scene
            recorded = self._recorded[1] if own and self._recorded else None
            told = [
                words.gaps(table, simulated, every),
                words.records(recorded),
                columns_hit(scene.slabs_on_columns),
            ]
            figure = charts.gaps_figure(table, recorded, simulated, every)
            panel.show(table, figure, " ".join(filter(None, told)))
        else:
            figure = charts.probability_figure(table, simulated)
            panel.show(table, figure, words.probability(table, simulated))

    def _draw_gaps(self) -> None:
        """Draw the gaps with or without a line for every rule; while they wait, the next answer does."""
        table = self._panels[GAPS].table
        if table is not None:
            self._draw(GAPS, table, self._scene)

    async def _simulate(self) -> None:
        scene = self._scene
        self._job = job = self._simulator.ask(SIMULATIONS, scene)
        self._running(True)
        self._told.text = "Simulating."
        look = ui.timer(LOOK, lambda: self._bar.props(f"value={job.share:.3f}"))
        try:
            tables = await asyncio.wrap_future(job.answer)
        except (Stopped, asyncio.CancelledError):
            self._told.text = "Stopped."
        except Exception as error:
            self._told.text = f"Not simulated: {_why(error, SIMULATIONS, scene)}"
        else:
            self._keep(scene, tables)
        finally:
            look.cancel()
            if self._job is job:
                self._job = None
                self._running(False)

    def _keep(self, scene: Scene, tables: Mapping[str, xr.Dataset]) -> None:
        if scene is not self._wanted:
            return
        self._simulated = tables
        self._told.text = f"Simulated: {scene.paths} motions, seed {scene.seed}."
        for key in tables:
            table = self._panels[key].table
            if table is not None:
                self._draw(key, table, scene)

    def _interrupt(self) -> None:
        if self._job is not None:
            self._job.stop()

    def _drop(self) -> None:
        """Stop what the patient one does for values that are gone."""
        if self._patience is not None:
            self._patience.stop()

    def _too_large(self) -> None:
        self._alert.text = f"The files are too large; allowed: {MOST_BYTES >> 20} MB in all."

    def _running(self, running: bool) -> None:
        self._start.set_enabled(self._wanted.settled and not running)
        for element in (self._stop, self._bar):
            element.set_visibility(running)

    def _save_case(self) -> None:
        told = [words.SAVED_LAST] if self._alert.text else []
        told += [*left_out(self._scene), words.beside(files_named(self._scene))]
        self._told.text = " ".join(filter(None, told)) or self._told.text
        file = self._scene.case_file
        name = file.file.name if file else "case.toml"
        ui.download.content(case_text(self._scene), name, "application/toml")

    def _save_data(self) -> None:
        tables = {key: p.table for key, p in self._panels.items() if p.table is not None}
        if self._recorded is not None and self._recorded[0] is self._scene:
            tables[RECORDS] = self._recorded[1]
        tables |= {f"simulated_{key}": table for key, table in self._simulated.items()}
        if self._alert.text:
            self._told.text = words.SAVED_LAST
        missing = [PANELS[key][0] for key in self._panels if key not in tables]
        if missing:
            self._told.text = f"Saved without results that are not computed yet: {', '.join(missing)}."
        data = as_netcdf(merge_tables(self._scene, tables))
        ui.download.content(data, "explored.nc", "application/x-netcdf")

    @property
    def _over(self) -> bool:
        """Whether nobody waits any longer: the page was left, or the server ends."""
        return self._closed or self._patient.closed

    def _leave(self) -> None:
        self._closed = True
        self._drop()
        self._interrupt()


def _at_once(scene: Scene) -> list[str]:
    """What is answered while a slider moves; all else in a process of its own."""
    if not scene.has_storeys:
        return list(FORMULAS)
    few = sum(floor_count(structure) for structure in scene.structures()) <= FEW_STOREYS
    return [SPECTRA, GAPS] if few else []


def _why(error: Exception, what: str, scene: Scene) -> str:
    """What to say of an error; a fault of ours, or a process that died, is logged."""
    if isinstance(error, REFUSED):
        return str(error)
    LOG.error("%s of %s", what, scene, exc_info=error)
    return f"{type(error).__name__}: {error}"


def _button(text: str, on_click: Callable[[], Any] | None, props: str) -> ui.button:
    color = None if "outline" in props else "primary"  # of an outline by the style sheet
    return ui.button(text, on_click=on_click, color=color).props(f"no-caps {props}")
