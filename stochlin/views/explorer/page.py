"""The explorer's page: controls beside charts, each of which is updated as fast as possible."""

from __future__ import annotations

import asyncio
import dataclasses
import logging
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from stochlin.analyses.explorer import formulas as exploration
from stochlin.analyses.explorer.case_text import case_text, files_named, left_out
from stochlin.analyses.explorer.simulations import merge_tables, with_motions
from stochlin.analyses.tables.inputs import MOST_BYTES
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.models.systems import floor_count
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import GROUPS, Control, counts, heading
from stochlin.views.explorer.entries import NumberEntry, choice_entry
from stochlin.views.explorer.panels import Panel
from stochlin.views.explorer.workers import (
    CORRELATION,
    GAPS,
    GROUND,
    MOTIONS,
    OPEN,
    PROBABILITY,
    RECORDS,
    SIMULATIONS,
    SPECTRA,
    Stopped,
)
from stochlin.views.shared.words import columns_hit

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

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
# The chart that a question belongs to; the ground is that of all charts.
PANEL_OF = {**{key: key for key in PANELS}, MOTIONS: PROBABILITY, RECORDS: GAPS}
FOLD = "if (innerWidth < 720) document.querySelectorAll('details').forEach(d => d.open = false)"
KEPT = "The charts keep the last values."
LOG = logging.getLogger("stochlin")
FORMULAS: dict[str, Callable[[Scene], xr.Dataset]] = {
    CORRELATION: exploration.correlation,
    SPECTRA: exploration.spectra,
    GAPS: exploration.gap_rules,
}
FEW_STOREYS = 24  # of both buildings, with which spectra and gaps are there at once
LOOK = 0.25  # s between two looks at how far the calculations are
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
        self._due = _questions(scene)  # what is not answered yet of the present values
        self._jobs: dict[str, Job] = {}  # what the workers have been asked
        self._chances: dict[str, xr.Dataset] = {}  # probability by formula and of few motions
        self._simulated: Mapping[str, xr.Dataset] = {}
        self._recorded: tuple[Scene, xr.Dataset] | None = None  # gaps of records, and of what values
        self._away, self._closed = False, False
        self._client = ui.context.client
        self._build(notes)
        self._client.on_disconnect(self._pause)
        self._client.on_connect(self._resume)
        self._client.on_delete(self._leave)
        ui.timer(LOOK, self._look)

    async def begin(self) -> None:
        """Fill the charts of a page that is connected."""
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
                    self._panels = {
                        key: Panel(*texts, key, self._stop_panel) for key, texts in PANELS.items()
                    }
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
                ui.label(heading(title, self._scene)).style("display: inline")
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
                files = ui.upload(on_multi_upload=_weakly(self._open), multiple=True, auto_upload=True)
                files.props(f"max-total-size={MOST_BYTES}").classes("files")
                files.on("rejected", _weakly(self._too_large))
                self._files = files
                pick = f"() => getElement({files.id}).pickFiles()"
                _button("Open case file", None, "outline data-open").on("click", js_handler=pick)
                _button("Save case file", self._save_case, "outline data-save-case")
                _button("Save dataset", self._save_data, "outline data-save-data")
            self._told = ui.label(words.START).props("role=status data-told")
        self._running()

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
        self._wanted, self._due = scene, _questions(scene)
        self._stop_all()  # at once: the next round may begin before the refresh
        self._simulated, self._chances = {}, {}
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
            scene, notes = await self._ask(self._patient, OPEN, files)
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

    def _ask(self, worker: Worker, question: str, subject: Any) -> Awaitable[Any]:
        """The answer of a worker; until then its job is one of the page's."""
        self._jobs[question] = job = worker.ask(question, subject)
        self._look()

        async def answer() -> Any:
            try:
                return await asyncio.wrap_future(job.answer)
            finally:
                if self._jobs.get(question) is job:
                    del self._jobs[question]

        return answer()

    async def _refresh(self) -> None:
        """Start the rounds that are not under way: those that are go on to the latest values."""
        if not await self._seek():
            return
        for key, panel in self._panels.items():
            if key in self._due and key not in _at_once(self._scene):
                panel.wait()
        self._look()
        await self._fast_round()  # first, for both want the processor
        await self._slow_round()

    async def _seek(self) -> bool:
        """Whether the ground of the present values is known, after a fit or a simulation if needed."""
        if self._seeking:
            return False
        self._seeking = True
        while self._due and not (self._wanted.settled or self._over):
            for panel in self._panels.values():
                panel.wait()
            self._running()
            wanted = self._wanted
            try:
                scene: Scene = await self._ask(self._patient, GROUND, wanted)
            except (Stopped, asyncio.CancelledError):  # for the sake of other values
                continue
            except Exception as error:
                if wanted is self._wanted:
                    self._end_all(_no_chart(_why(error, GROUND, wanted)))
                continue
            self._wanted = dataclasses.replace(
                self._wanted, fitted=scene.fitted, measured=scene.measured
            )
        self._seeking = False
        if self._wanted.settled:
            self._scene = self._wanted
        self._running()
        return self._wanted.settled

    def _next(self, at_once: bool) -> str | None:
        """The next question of the present values; none once there are others, or nobody waits."""
        if self._over or self._scene is not self._wanted:
            return None
        fast = _at_once(self._scene)
        return next((question for question in self._due if (question in fast) == at_once), None)

    async def _fast_round(self) -> None:
        if self._fast:
            return
        self._fast = True
        loop = asyncio.get_running_loop()
        while (question := self._next(at_once=True)) is not None:
            scene = self._scene
            await self._answer(question, scene, loop.run_in_executor(_FAST, FORMULAS[question], scene))
        self._fast = False

    async def _slow_round(self) -> None:
        if self._slow or self._fast:
            return
        self._slow = True
        while (question := self._next(at_once=False)) is not None:
            scene = self._scene
            answer = self._ask(self._patient, question, scene)
            await self._answer(question, scene, answer)
        self._slow = False

    async def _answer(self, question: str, scene: Scene, answer: Awaitable[xr.Dataset]) -> None:
        """Draw an answer, or say why there is none; no error ends a round."""
        table, why = None, ""
        try:
            table = await answer
        except (Stopped, asyncio.CancelledError):  # for the sake of other values, or of none
            return
        except Exception as error:
            why = _why(error, question, scene)
        if self._over:
            return
        present = scene is self._wanted
        if present:
            self._due = [other for other in self._due if other != question]
        if table is None:
            self._fail(question, why)
        elif question == RECORDS:
            self._recorded = scene, table
            self._draw_gaps()
        elif question not in (MOTIONS, PROBABILITY):
            self._draw(question, table, scene)
            if not present:
                self._panels[question].wait()
        elif present:
            self._chances[question] = table
            self._draw_chances(scene)
        self._look()

    def _fail(self, question: str, why: str) -> None:
        """Say why a question about the present values has no answer."""
        if question == RECORDS:
            self._told.text = f"The records were not evaluated: {why}"
        elif question != MOTIONS:  # the formula follows, and says the same
            self._panels[question].end(_no_chart(why))

    def _draw_chances(self, scene: Scene) -> None:
        """Draw the probability by formula, of few motions, or by both, as far as they are known."""
        table = with_motions(self._chances.get(PROBABILITY), self._chances.get(MOTIONS))
        if table is not None:
            self._draw(PROBABILITY, table, scene)

    def _draw(self, key: str, table: xr.Dataset, scene: Scene) -> None:
        """Draw a table, beside it the simulation of the present values if there is one."""
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
            texts = [
                words.gaps(table, simulated, every),
                words.records(recorded),
                columns_hit(scene.slabs_on_columns),
            ]
            figure = charts.gaps_figure(table, recorded, simulated, every)
            panel.show(table, figure, " ".join(filter(None, texts)))
        else:
            figure = charts.probability_figure(table, simulated)
            more = PROBABILITY in self._due
            panel.show(table, figure, words.probability(table, simulated), more)

    def _draw_gaps(self) -> None:
        """Draw the gaps with or without a line for every rule; while they wait, the next answer does."""
        table = self._panels[GAPS].table
        if table is not None:
            self._draw(GAPS, table, self._scene)

    async def _simulate(self) -> None:
        scene = self._scene
        answer = self._ask(self._simulator, SIMULATIONS, scene)
        self._told.text = "Simulating."
        self._running()
        try:
            tables = await answer
        except (Stopped, asyncio.CancelledError):
            self._told.text = "Stopped."
        except Exception as error:
            self._told.text = f"Not simulated: {_why(error, SIMULATIONS, scene)}"
        else:
            self._keep(scene, tables)
        self._running()

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
        if SIMULATIONS in self._jobs:
            self._jobs[SIMULATIONS].stop()

    def _stop_all(self) -> None:
        for job in list(self._jobs.values()):
            job.stop()

    def _stop_panel(self, key: str) -> None:
        """Give up what a chart waits for; of the ground, all charts give up."""
        if self._seeking:
            self._end_all(words.STOPPED)
            return
        self._due = [question for question in self._due if PANEL_OF[question] != key]
        for question, job in list(self._jobs.items()):
            if PANEL_OF.get(question) == key:
                job.stop()
        self._panels[key].end(words.STOPPED)

    def _end_all(self, why: str) -> None:
        """No chart waits any longer, and why."""
        self._due = []
        if GROUND in self._jobs:
            self._jobs[GROUND].stop()
        for panel in self._panels.values():
            panel.end(why)

    def _look(self) -> None:
        """Say what each chart waits for, and how far it is."""
        if SIMULATIONS in self._jobs:
            self._bar.props(f"value={self._jobs[SIMULATIONS].share:.3f}")
        jobs = [job for job in self._jobs.values() if job.question in words.DOING]
        before = words.after([PANELS[PANEL_OF.get(job.question, GAPS)][0] for job in jobs])
        for key, panel in self._panels.items():
            if not panel.waiting:
                continue
            own = [job for job in jobs if PANEL_OF.get(job.question, key) == key]
            if not own:
                panel.tell(before, None, bool(jobs))
            elif own[0].answer.running():
                panel.tell(words.DOING[own[0].question], own[0].share, True)
            else:
                panel.tell(words.BUSY, None, True)

    def _too_large(self, _: object) -> None:
        self._alert.text = f"The files are too large; allowed: {MOST_BYTES >> 20} MB in all."

    def _running(self) -> None:
        """Show whether a simulation runs, and whether one can be started."""
        running = SIMULATIONS in self._jobs
        self._start.set_enabled(self._wanted.settled and not running)
        for element in (self._stop, self._bar):
            element.set_visibility(running)

    def _save_case(self) -> None:
        texts = [words.SAVED_LAST] if self._alert.text else []
        texts += [*left_out(self._scene), words.beside(files_named(self._scene))]
        self._told.text = " ".join(filter(None, texts)) or self._told.text
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
        """Whether nobody waits at present: the page was left, or the server ends."""
        return self._closed or self._away or self._patient.closed

    def _pause(self) -> None:
        """Compute nothing for a page that has lost its connection; perhaps its tab is closed."""
        self._away = not self._client.has_socket_connection
        if self._away:
            self._stop_all()

    async def _resume(self) -> None:
        """Go on with a page that is connected again."""
        if self._away:
            self._away = False
            await self._refresh()

    def _leave(self) -> None:
        self._closed = True
        self._stop_all()


def _questions(scene: Scene) -> list[str]:
    """What is asked about a scene, in this order; with storeys the formula last, which takes longest."""
    records = [RECORDS] if scene.records else []
    if scene.has_storeys:
        return [SPECTRA, GAPS, MOTIONS, CORRELATION, *records, PROBABILITY]
    return [CORRELATION, SPECTRA, GAPS, PROBABILITY, *records]


def _at_once(scene: Scene) -> list[str]:
    """What is answered while a slider moves; all else in a process of its own."""
    if not scene.has_storeys:
        return list(FORMULAS)
    few = sum(floor_count(structure) for structure in scene.structures()) <= FEW_STOREYS
    return [SPECTRA, GAPS] if few else []


def _weakly(method: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A handler of the upload that does not keep its page, for the server keeps the upload."""
    kept = weakref.WeakMethod(method)

    def handler(event: Any) -> Any:
        present = kept()
        return present(event) if present else None

    return handler


def _no_chart(why: str) -> str:
    return f"These values have no chart: {why}"


def _why(error: Exception, what: str, scene: Scene) -> str:
    """What to say of an error; a fault of ours, or a process that died, is logged."""
    if isinstance(error, REFUSED):
        return str(error)
    LOG.error("%s of %s", what, scene, exc_info=error)
    return f"{type(error).__name__}: {error}"


def _button(text: str, on_click: Callable[[], Any] | None, props: str) -> ui.button:
    color = None if "outline" in props else "primary"  # of an outline by the style sheet
    return ui.button(text, on_click=on_click, color=color).props(f"no-caps {props}")
