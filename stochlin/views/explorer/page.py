"""The explorer's page: a form of a case file beside the gap, its picture and the rules."""

from __future__ import annotations

import asyncio
import gc
import weakref
from contextlib import suppress
from typing import TYPE_CHECKING

from nicegui import background_tasks, ui

from stochlin.applications.explorer.form import changed_text, form_of
from stochlin.applications.explorer.uploads import Upload, uploaded
from stochlin.files.inputs import MOST_BYTES
from stochlin.messages import LONGEST_MESSAGE, sentence
from stochlin.views.explorer.answering import REFUSAL_ERRORS
from stochlin.views.explorer.answers import TABS
from stochlin.views.explorer.rows import TYPING, EntryRow
from stochlin.views.explorer.workers import Job, NoAnswer, Stopped

if TYPE_CHECKING:
    from nicegui import events

    from stochlin.applications.explorer.form import FormEntry
    from stochlin.views.explorer.workers import Worker

PAUSE = 0.5  # s after the last change, before the answer is computed anew
REFRESH_INTERVAL = 0.25  # s between two looks at how far the work is
NOT_SENT = f"The files were not opened; allowed: {MOST_BYTES >> 20} MB in all, and 1000 files."
HEADING = "How far must two buildings on the same ground stand apart?"


class Page:
    """One browser's view of a case. Its state is the text of the case file."""

    def __init__(self, start: Upload, worker: Worker) -> None:
        self._upload = start
        self._shared = start
        self._text = start.text
        self._worker = worker
        self._job = Job(wanted=False)  # the last one
        self._answered: dict[str, tuple[str, str]] = {}  # of each tab, the text and its answer
        self._client = ui.context.client
        self._build()
        self._show_form()
        self._client.on_disconnect(self._compute)  # which stops: perhaps its tab is closed
        self._client.on_connect(self._compute)
        self._client.on_delete(self._leave)
        ui.timer(REFRESH_INTERVAL, self._look)
        self._tabs.value = "Gap"

    def _build(self) -> None:
        ui.colors(primary="#2166ac")
        ui.link("To the answer", "#answer").classes("skip")
        with ui.element("header").classes("head"):
            with ui.element("h1"):
                ui.label(HEADING)
            page = weakref.proxy(self)  # FastAPI never lets go of what receives files
            self._files = ui.upload(multiple=True, auto_upload=True, max_total_size=MOST_BYTES)
            self._files.on_multi_upload(lambda event: page._open(event))  # noqa: PLW0108
            self._files.props("batch").classes("files")
            self._files.on("rejected", lambda: page._not_sent(), args=[])  # noqa: PLW0108
            pick = f"() => getElement({self._files.id}).pickFiles()"
            _button("Open case file", "data-open").on("click", js_handler=pick)
            _button("Save case file", "data-save").on_click(self._save)
        with ui.element("main").classes("sheet"):
            with ui.element("form").classes("controls").props('onsubmit="return false"'):
                self._form = ui.element("div")
                with ui.element("details"):
                    with ui.element("summary"):
                        ui.label("Text of the case file").style("display: inline")
                    self._source = ui.textarea(on_change=self._typed).props("outlined data-text")
                    self._source.props(f"debounce={TYPING} autogrow spellcheck=false")
                    self._source.props["aria-label"] = "Text of the case file"
            with ui.element("div").props("id=answer tabindex=-1"):
                with ui.tabs(on_change=self._compute) as self._tabs:
                    self._tabs.props("no-caps align=left dense")
                    for name in TABS:
                        ui.tab(name).props(f"data-tab={name}")
                self._state = ui.label().classes("state").props("role=status data-state")
                self._alert = ui.label().classes("wrong").props("role=alert data-alert")
                self._answer = ui.html("", sanitize=False)  # what is the user's is escaped in it
                self._answer.classes("answer").props("data-answer")

    def _show_form(self) -> None:
        """The form of the present text; none if it is no TOML, which the reader says."""
        self._form.clear()
        self._source.value = self._text
        with self._form, suppress(ValueError):
            for title, entries in form_of(self._text):
                with ui.element("details").props("open"):
                    with ui.element("summary"):
                        ui.label(title).style("display: inline")
                    for entry in entries:
                        EntryRow(entry, title, self._change)

    def _change(self, entry: FormEntry) -> None:
        """Take another value of a key."""
        self._text = changed_text(self._text, entry)
        self._source.value = self._text
        self._compute(PAUSE)

    def _typed(self, event: events.ValueChangeEventArguments[str | None]) -> None:
        """Take another text."""
        if event.value != self._text:
            self._text = event.value or ""
            self._show_form()
            self._compute(PAUSE)

    def _compute(self, pause: float = 0.0) -> None:
        """Stop what is computed; compute the present tab anew after a pause, if a browser looks."""
        self._job.wanted = False
        tab = str(self._tabs.value)
        text, self._answer.content = self._answered.get(tab, (None, ""))
        self._job = Job(text != self._text and self._client.has_socket_connection)
        if self._job.wanted:
            background_tasks.create(self._find(self._job, tab, pause))
        else:
            self._alert.text = ""
        self._look()

    async def _find(self, job: Job, tab: str, pause: float) -> None:
        """Show an answer, or say why there is none, unless something else is wanted meanwhile."""
        await asyncio.sleep(pause)
        upload = self._upload
        text = self._text
        why = ""
        try:
            answer = await self._worker.answer(job, tab, upload.folder, upload.name, text)
        except Stopped:  # for the sake of other values, or of none
            return
        except NoAnswer as error:
            why = str(error)
        if not job.wanted:
            return
        job.wanted = False
        self._alert.text = why
        if not why:
            self._answer.content = answer
            self._answered[tab] = text, answer
        self._look()

    def _look(self) -> None:
        """Say whether something is computed, and how far it is."""
        job = self._job
        old = self._answered.get(str(self._tabs.value), ("",))[0] != self._text
        self._state.text = f"Computing ... {100 * job.share:.0f} %" if job.wanted else ""
        self._answer.classes(**{"add" if old else "remove": "stale"})

    async def _open(self, event: events.MultiUploadEventArguments) -> None:
        """Show another case file; one that cannot be opened changes nothing."""
        files = {file.name: await file.read() for file in event.files}
        self._files.reset()
        try:
            opened = await asyncio.to_thread(uploaded, files)
        except REFUSAL_ERRORS as error:
            self._alert.text = f"The file was not opened: {sentence(error, LONGEST_MESSAGE)}"
            return
        self._remove_folder()
        self._upload = opened
        self._text = opened.text
        self._answered.clear()
        self._show_form()
        self._compute()

    def _not_sent(self) -> None:
        self._files.reset()  # or they were sent again with the next ones
        self._alert.text = NOT_SENT

    def _save(self) -> None:
        ui.download.content(self._text, self._upload.name, "application/toml")

    def _leave(self) -> None:
        self._job.wanted = False
        self._remove_folder()
        # The parts of a page refer to each other.
        asyncio.get_running_loop().call_later(1.0, gc.collect)

    def _remove_folder(self) -> None:
        """Remove the files of this page; those with which the server started are of all pages."""
        if self._upload is not self._shared:
            self._upload.remove()


def _button(text: str, mark: str) -> ui.button:
    return ui.button(text, color=None).props(f"no-caps outline {mark}")
