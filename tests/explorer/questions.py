"""Questions for the process beside the page; each has the text before it, and ``progress``."""

import tempfile
import time
from typing import Any

from browser import PATIENCE


def twice(text: str, progress: Any) -> str:
    return 2 * text


def patient(text: str, progress: Any) -> str:
    """Work that looks whether it is still wanted."""
    for step in range(int(PATIENCE / 0.01)):
        progress(step * 0.01 / PATIENCE)
        time.sleep(0.01)
    return text


def stubborn(text: str, progress: Any) -> str:
    """Work that never looks."""
    progress(0.1)
    time.sleep(PATIENCE)
    return text


def refuse(text: str, progress: Any) -> str:
    raise ValueError(f"{text} is refused")


def fail(text: str, progress: Any) -> str:
    raise RuntimeError(text)


def nest(text: str, progress: Any) -> str:
    """An error whose value is nested too deeply to be sent."""
    value: list[Any] = []
    for _ in range(100_000):
        value = [value]
    raise ValueError(value)


def talk(text: str, progress: Any) -> str:
    print("a library that talks")  # noqa: T201
    return text


def folder_of_files(text: str, progress: Any) -> str:
    return tempfile.gettempdir()


QUESTIONS = {
    "twice": twice,
    "patient": patient,
    "stubborn": stubborn,
    "refuse": refuse,
    "fail": fail,
    "nest": nest,
    "talk": talk,
    "folder": folder_of_files,
}
