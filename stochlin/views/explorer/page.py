"""The explorer's page: a form of a case file beside the gap, its picture and the rules."""

from __future__ import annotations

import asyncio
import logging
import traceback
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui

from stochlin.analyses.explorer.form import AS_IN_FILE, changed_text, chosen, form_of
from stochlin.analyses.explorer.uploads import Upload, uploaded
from stochlin.analyses.tables.inputs import MOST_BYTES
from stochlin.analyses.tables.toml import toml_tables, toml_text
from stochlin.messages import LONGEST_MESSAGE, sentence
from stochlin.views.explorer.answers import correlation_of, gap_of
from stochlin.views.explorer.rows import TYPING, EntryRow, choice_row
from stochlin.views.explorer.workers import Stopped

if TYPE_CHECKING:
    from nicegui import events

    from stochlin.analyses.explorer.form import Choice, Entry
    from stochlin.views.explorer.workers import Job, Worker

QUESTIONS = {"Gap": gap_of, "Correlation": correlation_of}  # of each tab
FIRST = "Gap"
PAUSE = 0.5  # s after the last change, before the answer is computed anew
LOOK = 0.25  # s between two looks at how far the work is
REFUSED = (ValueError, TypeError, ArithmeticError, MemoryError, OSError)
NOT_SENT = f"The files were not opened; allowed: {MOST_BYTES >> 20} MB in all, and 1000 files."
HEADING = "How far must two buildings on the same ground stand apart?"
FOLD = "if (innerWidth < 720) document.querySelectorAll('details').forEach(d => d.open = false)"
LOG = logging.getLogger("stochlin")


class Page:
    """One browser's view of a case. Its state is the text of the case file."""

    def __init__(self, start: Upload, worker: Worker) -> None:
        self._upload, self._shared = start, start
        self._text, self._tables = start.text, toml_tables(start.text)
        self._worker = worker
        self._job: Job | None = None
        self._changes = 0
        self._waiting = False
        self._answered: dict[str, str] = {}  # the text that each tab answers
        self._client = ui.context.client
        self._build()
        self._show_case()
        self._client.on_disconnect(self._pause)
        self._client.on_connect(lambda: self._compute(0.0))
        self._client.on_delete(self._leave)
        ui.timer(LOOK, self._look)

    def begin(self) -> None:
        """Fill a page that is connected."""
        ui.run_javascript(FOLD)
        self._tabs.value = FIRST

    def _build(self) -> None:
        ui.colors(primary="#2166ac")
        ui.link("To the answer", "#answer").classes("skip")
        with ui.element("header").classes("head"):
            with ui.element("h1"):
                ui.label(HEADING)
            self._files = ui.upload(on_multi_upload=self._open, multiple=True, auto_upload=True)
            self._files.props(f"max-total-size={MOST_BYTES}").classes("files")
            for failure in ("rejected", "failed"):
                self._files.on(failure, self._not_sent, args=[])
            pick = f"() => getElement({self._files.id}).pickFiles()"
            _button("Open case file", "data-open").on("click", js_handler=pick)
            _button("Save case file", "data-save").on_click(self._save)
        with ui.element("main").classes("sheet"):
            with ui.element("div").classes("controls"):
                self._form = ui.element("form").props('onsubmit="return false"')
                with ui.element("details").props("data-source"):
                    with ui.element("summary"):
                        ui.label("The whole case file as text").style("display: inline")
                    self._source = ui.textarea(on_change=self._typed)
                    self._source.props(f"outlined debounce={TYPING} spellcheck=false rows=24")
                    self._source.props('data-text aria-label="Case file"')
            with ui.element("div").props("id=answer tabindex=-1"):
                with ui.tabs(on_change=self._turn).props("no-caps align=left dense") as self._tabs:
                    for name in QUESTIONS:
                        ui.tab(name).props(f"data-tab={name}")
                with ui.element("div").classes("state"):
                    self._state = ui.label().props("role=status data-state")
                    self._bar = ui.element("progress").props(
                        'max=1 value=0 aria-label="Share of the work"'
                    )
                self._alert = ui.label().classes("wrong").props("role=alert data-alert")
                self._answers = {
                    name: ui.html("", sanitize=False).classes("answer").props(f"data-answer={name}")
                    for name in QUESTIONS  # what is the user's is escaped in it
                }

    def _show_case(self) -> None:
        """The form and the text of the present tables."""
        self._source.value = self._text
        self._form.clear()
        with self._form:
            for group in form_of(self._tables):
                with ui.element("details").props("open"):
                    with ui.element("summary"):
                        ui.label(group.title).style("display: inline")
                    for choice in group.choices:
                        choice_row(choice, self._choose)
                    for entry in group.entries:
                        EntryRow(entry, group.title, self._change)

    def _change(self, entry: Entry, value: Any) -> None:
        """Take another value of a key."""
        self._take(changed_text(self._text, entry, value))
        self._source.value = self._text

    def _choose(self, choice: Choice, option: str) -> None:
        """Take the keys of another choice; what the file says otherwise is no choice."""
        if option in (choice.present, AS_IN_FILE):
            return
        self._take(toml_text(chosen(self._tables, choice, option)))
        self._show_case()

    def _typed(self, event: events.ValueChangeEventArguments[Any]) -> None:
        """Take another text of the whole case; until it is TOML, the form waits."""
        if (event.value or "") != self._text:
            self._take(event.value or "")
            if "inert" not in self._form.props:
                self._show_case()

    def _take(self, text: str) -> None:
        self._text = text
        try:
            self._tables = toml_tables(text)
        except ValueError:
            self._form.props("inert")
        else:
            self._form.props(remove="inert")
        self._compute(PAUSE)

    def _turn(self) -> None:
        """Answer the question of another tab."""
        for name, answer in self._answers.items():
            answer.set_visibility(name == self._tabs.value)
        self._compute(0.0)

    def _compute(self, pause: float) -> None:
        """Stop what is computed, and compute the present tab anew after a pause."""
        self._changes += 1
        if self._job is not None:
            self._job.stop()
        tab = str(self._tabs.value)
        self._waiting = self._answered.get(tab) != self._text and self._client.has_socket_connection
        self._answers[tab].classes(**{"add" if self._waiting else "remove": "stale"})
        if self._waiting:
            background_tasks.create(self._answer(tab, self._text, self._changes, pause))
        else:
            self._alert.text = ""
        self._look()

    async def _answer(self, tab: str, text: str, change: int, pause: float) -> None:
        """Show an answer, or say why there is none, unless something else is wanted meanwhile."""
        await asyncio.sleep(pause)
        if change != self._changes:
            return
        upload, why = self._upload, ""
        job = self._job = self._worker.ask(QUESTIONS[tab], upload.folder.name, upload.name, text)
        try:
            answer = await asyncio.wrap_future(job.answer)
        except (Stopped, asyncio.CancelledError):  # for the sake of other values, or of none
            return
        except Exception as error:
            answer, why = None, _why(error)
        if change != self._changes:
            return
        self._waiting, self._job, self._alert.text = False, None, why
        if answer is not None:
            self._answers[tab].content = answer
            self._answers[tab].classes(remove="stale")
            self._answered[tab] = text
        self._look()

    def _look(self) -> None:
        """Say whether something is computed, and how far it is."""
        self._state.text = "Computing ..." if self._waiting else ""
        self._bar.set_visibility(self._waiting)
        self._bar.props(f"value={self._job.share if self._job else 0:.3f}")

    async def _open(self, event: events.MultiUploadEventArguments) -> None:
        """Show another case file; one that cannot be opened changes nothing."""
        files = {PurePath(file.name).name: await file.read() for file in event.files}
        self._files.reset()
        try:
            opened = await asyncio.to_thread(uploaded, files)
        except REFUSED as error:
            self._alert.text = f"The file was not opened: {_why(error)}"
            return
        self._remove_folder()
        self._upload = opened
        self._answered.clear()
        self._take(opened.text)
        self._show_case()
        ui.run_javascript(FOLD)

    def _not_sent(self) -> None:
        self._files.reset()  # or they were sent again with the next ones
        self._alert.text = NOT_SENT

    def _save(self) -> None:
        ui.download.content(self._text, self._upload.name, "application/toml")

    def _pause(self) -> None:
        """Compute nothing for a page that has lost its connection; perhaps its tab is closed."""
        if not self._client.has_socket_connection:
            self._compute(0.0)

    def _leave(self) -> None:
        self._changes += 1
        if self._job is not None:
            self._job.stop()
        self._remove_folder()

    def _remove_folder(self) -> None:
        """Remove the files of this page; those with which the server started are of all pages."""
        if self._upload is not self._shared:
            self._upload.folder.cleanup()


def _why(error: Exception) -> str:
    """What to say of an error; a fault of ours, or a process that died, is logged."""
    if not isinstance(error, REFUSED):
        for line in "".join(traceback.format_exception(error)).splitlines():
            LOG.error("%s", line)
    return sentence(error, LONGEST_MESSAGE)


def _button(text: str, mark: str) -> ui.button:
    return ui.button(text, color=None).props(f"no-caps outline {mark}")
