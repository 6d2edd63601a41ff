"""The explorer's page: controls beside charts, each of which is updated as fast as possible."""

from __future__ import annotations

import asyncio
import logging
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from stochlin.analyses.explorer import formulas as exploration
from stochlin.analyses.explorer.form import STRENGTHS, NumberControl, groups, numbers
from stochlin.analyses.explorer.pair import (
    elastic_periods,
    equivalent_strength,
    has_storeys,
    structures_of,
)
from stochlin.analyses.explorer.saving import case_text, files_named, left_out
from stochlin.analyses.explorer.simulations import merge_tables, with_motions
from stochlin.analyses.tables.inputs import MOST_BYTES
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.models.systems import floor_count
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import heading, read_entry, text_of
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

    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.explorer.form import Form, Place
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
FORMULAS: dict[str, Callable[[Case], xr.Dataset]] = {
    CORRELATION: exploration.correlation,
    SPECTRA: exploration.spectra,
    GAPS: exploration.gap_rules,
}
FEW_STOREYS = 24  # of both buildings, with which spectra and gaps are there at once
LOOK = 0.25  # s between two looks at how far the calculations are
# One thread for all pages: numpy's work between Python's steps gains nothing from more.
_FAST = ThreadPoolExecutor(1, thread_name_prefix="explorer")


class Page:
    """One browser's view of a case."""

    def __init__(self, form: Form, notes: list[str], patient: Worker, simulator: Worker) -> None:
        self._form = form  # what the controls say, even where that is no valid case
        # The last valid case, and the last one whose ground is known: that is what is shown.
        self._wanted = self._case = form.case()
        self._patient, self._simulator = patient, simulator
        self._wrong: dict[Place, str] = {}  # messages of entries that cannot be read
        self._rows: dict[Place, Any] = {}
        self._entries: dict[Place, NumberEntry] = {}
        self._fast, self._slow = False, False  # whether a round is under way
        self._seeking = False  # whether a ground is sought
        self._due = _questions(self._case)  # what is not answered yet of the present values
        self._jobs: dict[str, Job] = {}  # what the workers have been asked
        self._chances: dict[str, xr.Dataset] = {}  # probability by formula and of few motions
        self._simulated: Mapping[str, xr.Dataset] = {}
        self._recorded: tuple[Case, xr.Dataset] | None = None  # gaps of records, and of what values
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
            self._controls = ui.element("form").classes("controls").props('onsubmit="return false"')
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
        self._title.text = self._case.title
        self._notes.clear()
        with self._notes:
            for note in notes:
                ui.label(note)
        self._controls.clear()
        with self._controls:
            for group in groups():
                self._group(group.title, group.controls)
        self._hide()

    def _group(self, title: str, controls: Any) -> None:
        with ui.element("details").props("open"):
            with ui.element("summary"):
                ui.label(heading(title, self._form)).style("display: inline")
            for control in controls:
                if isinstance(control, NumberControl):
                    entry = NumberEntry(control, title, self._form, self._change)
                    self._entries[control.place], row = entry, entry.row
                else:
                    row = choice_entry(control, title, self._form, self._change)
                self._rows[control.place] = row

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

    def _change(self, place: Place, value: Any, wrong: str) -> None:
        """Take another value of a control; if it is not valid, the charts keep the last values."""
        self._wrong.pop(place, None)
        if wrong:
            self._wrong[place] = wrong
        else:
            self._form = self._form.changed({place: value})
            if place[1] == "strength":
                self._keep_strength(place[0])
            self._hide()
        messages = list(self._wrong.values())
        if not messages:
            try:
                case = self._form.case()
            except (ValueError, TypeError) as error:
                messages = [f"These values do not fit: {error}."]
        self._alert.text = " ".join([*messages, KEPT] if messages else [])
        if not messages and case != self._wanted:
            self._take(case)

    def _take(self, case: Case) -> None:
        """Other values, of which nothing is simulated."""
        self._wanted, self._due = case, _questions(case)
        self._stop_all()  # at once: the next round may begin before the refresh
        self._simulated, self._chances = {}, {}
        self._told.text = words.START
        background_tasks.create(self._refresh())

    def _keep_strength(self, building: str) -> None:
        """Start the other way to give the strength of an oscillator with the strength that it has."""
        if self._case.of_site.waits:  # the strength is not known before the ground
            return
        try:
            key, value = equivalent_strength(self._case, int(building[-1]))
            number = next(n for n in numbers() if n.place == (building, key))
            changed = self._form.changed({number.place: value})
            read_entry(number, text_of(number, changed))
        except REFUSED:  # elastic, or beyond what may be entered: the control starts as it stands
            return
        if STRENGTHS[self._form[building, "strength"]] == key:
            self._form = changed
            self._entries[number.place].show(changed)

    async def _open(self, event: events.MultiUploadEventArguments) -> None:
        """Show another case file; one that cannot be read changes nothing."""
        files = {PurePath(file.name).name: await file.read() for file in event.files}
        self._files.reset()
        self._told.text = "Opening the case file ..."
        try:
            form, notes = await self._ask(self._patient, OPEN, files)
            case = form.case()
        except (Stopped, asyncio.CancelledError):
            return
        except Exception as error:
            self._told.text = ""
            self._alert.text = f"The file was not opened: {_why(error, OPEN, self._case)}"
            return
        self._form, self._case, self._wrong = form, case, {}
        self._alert.text = ""
        self._show_controls(notes)
        ui.run_javascript(FOLD)
        self._take(case)

    def _hide(self) -> None:
        for place, row in self._rows.items():
            row.set_visibility(self._form.uses(place))

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
            if key in self._due and key not in _at_once(self._case):
                panel.wait()
        self._look()
        await self._fast_round()  # first, for both want the processor
        await self._slow_round()

    async def _seek(self) -> bool:
        """Whether the ground of the present values is known, after a fit or a simulation if needed."""
        if self._seeking:
            return False
        self._seeking = True
        while self._due and self._wanted.of_site.waits and not self._over:
            for panel in self._panels.values():
                panel.wait()
            self._running()
            wanted = self._wanted
            try:
                known = await self._ask(self._patient, GROUND, wanted)
            except (Stopped, asyncio.CancelledError):  # for the sake of other values
                continue
            except Exception as error:
                if wanted is self._wanted:
                    self._end_all(_no_chart(_why(error, GROUND, wanted)))
                continue
            for name, found in known.items():
                self._wanted.of_site.known.keep(name, found)
        self._seeking = False
        settled = not self._wanted.of_site.waits
        if settled:
            self._case = self._wanted
        self._running()
        return settled

    def _next(self, at_once: bool) -> str | None:
        """The next question of the present values; none once there are others, or nobody waits."""
        if self._over or self._case is not self._wanted:
            return None
        fast = _at_once(self._case)
        return next((question for question in self._due if (question in fast) == at_once), None)

    async def _fast_round(self) -> None:
        if self._fast:
            return
        self._fast = True
        loop = asyncio.get_running_loop()
        while (question := self._next(at_once=True)) is not None:
            case = self._case
            await self._answer(question, case, loop.run_in_executor(_FAST, FORMULAS[question], case))
        self._fast = False

    async def _slow_round(self) -> None:
        if self._slow or self._fast:
            return
        self._slow = True
        while (question := self._next(at_once=False)) is not None:
            case = self._case
            answer = self._ask(self._patient, question, case)
            await self._answer(question, case, answer)
        self._slow = False

    async def _answer(self, question: str, case: Case, answer: Awaitable[xr.Dataset]) -> None:
        """Draw an answer, or say why there is none; no error ends a round."""
        table, why = None, ""
        try:
            table = await answer
        except (Stopped, asyncio.CancelledError):  # for the sake of other values, or of none
            return
        except Exception as error:
            why = _why(error, question, case)
        if self._over:
            return
        present = case is self._wanted
        if present:
            self._due = [other for other in self._due if other != question]
        if table is None:
            self._fail(question, why)
        elif question == RECORDS:
            self._recorded = case, table
            self._draw_gaps()
        elif question not in (MOTIONS, PROBABILITY):
            self._draw(question, table, case)
            if not present:
                self._panels[question].wait()
        elif present:
            self._chances[question] = table
            self._draw_chances(case)
        self._look()

    def _fail(self, question: str, why: str) -> None:
        """Say why a question about the present values has no answer."""
        if question == RECORDS:
            self._told.text = f"The records were not evaluated: {why}"
        elif question != MOTIONS:  # the formula follows, and says the same
            self._panels[question].end(_no_chart(why))

    def _draw_chances(self, case: Case) -> None:
        """Draw the probability by formula, of few motions, or by both, as far as they are known."""
        table = with_motions(self._chances.get(PROBABILITY), self._chances.get(MOTIONS))
        if table is not None:
            self._draw(PROBABILITY, table, case)

    def _draw(self, key: str, table: xr.Dataset, case: Case) -> None:
        """Draw a table, beside it the simulation of the present values if there is one."""
        simulated = self._simulated.get(key) if case is self._case else None
        panel = self._panels[key]
        if key == SPECTRA:
            if has_storeys(case):
                self._caution.text, self._why.text = words.caution_of_storeys(case)
            periods = elastic_periods(case)
            panel.show(table, charts.spectra_figure(table, periods), words.spectra(table))
        elif key == CORRELATION:
            if not has_storeys(case):
                self._caution.text, self._why.text = words.caution(table)
            panel.show(table, charts.correlation_figure(table, simulated), words.correlation(table))
        elif key == GAPS:
            every = bool(self._every.value)
            own = self._recorded is not None and self._recorded[0] is case
            recorded = self._recorded[1] if own and self._recorded else None
            texts = [
                words.gaps(table, simulated, every),
                words.records(recorded),
                columns_hit(case.slabs_on_columns),
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
            self._draw(GAPS, table, self._case)

    async def _simulate(self) -> None:
        case = self._case
        answer = self._ask(self._simulator, SIMULATIONS, case)
        self._told.text = "Simulating."
        self._running()
        try:
            tables = await answer
        except (Stopped, asyncio.CancelledError):
            self._told.text = "Stopped."
        except Exception as error:
            self._told.text = f"Not simulated: {_why(error, SIMULATIONS, case)}"
        else:
            self._keep(case, tables)
        self._running()

    def _keep(self, case: Case, tables: Mapping[str, xr.Dataset]) -> None:
        if case is not self._wanted:
            return
        self._simulated = tables
        self._told.text = f"Simulated: {case.paths} motions, seed {case.seed}."
        for key in tables:
            table = self._panels[key].table
            if table is not None:
                self._draw(key, table, case)

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
        self._start.set_enabled(not (self._wanted.of_site.waits or running))
        for element in (self._stop, self._bar):
            element.set_visibility(running)

    def _save_case(self) -> None:
        case = self._case
        texts = [words.SAVED_LAST] if self._alert.text else []
        texts += [*left_out(case, self._form.file), words.beside(files_named(case))]
        self._told.text = " ".join(filter(None, texts)) or self._told.text
        ui.download.content(case_text(case), case.file, "application/toml")

    def _save_data(self) -> None:
        if self._case.of_site.waits:
            self._told.text = "There is nothing to save yet: the ground is not known."
            return
        tables = {key: p.table for key, p in self._panels.items() if p.table is not None}
        if self._recorded is not None and self._recorded[0] is self._case:
            tables[RECORDS] = self._recorded[1]
        tables |= {f"simulated_{key}": table for key, table in self._simulated.items()}
        if self._alert.text:
            self._told.text = words.SAVED_LAST
        missing = [PANELS[key][0] for key in self._panels if key not in tables]
        if missing:
            self._told.text = f"Saved without results that are not computed yet: {', '.join(missing)}."
        data = as_netcdf(merge_tables(self._case, tables))
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


def _questions(case: Case) -> list[str]:
    """What is asked about a case, in this order; with storeys the formula last, which takes longest."""
    records = [RECORDS] if case.of_site.recorded else []
    if has_storeys(case):
        return [SPECTRA, GAPS, MOTIONS, CORRELATION, *records, PROBABILITY]
    return [CORRELATION, SPECTRA, GAPS, PROBABILITY, *records]


def _at_once(case: Case) -> list[str]:
    """What is answered while a slider moves; all else in a process of its own."""
    if not has_storeys(case):
        return list(FORMULAS)
    few = sum(floor_count(structure) for structure in structures_of(case)) <= FEW_STOREYS
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


def _why(error: Exception, what: str, case: Case) -> str:
    """What to say of an error; a fault of ours, or a process that died, is logged."""
    if isinstance(error, REFUSED):
        return str(error)
    LOG.error("%s of %s", what, case, exc_info=error)
    return f"{type(error).__name__}: {error}"


def _button(text: str, on_click: Callable[[], Any] | None, props: str) -> ui.button:
    color = None if "outline" in props else "primary"  # of an outline by the style sheet
    return ui.button(text, on_click=on_click, color=color).props(f"no-caps {props}")
