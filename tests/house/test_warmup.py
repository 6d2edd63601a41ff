"""After ``stochlin warmup`` nothing is compiled any more."""

import importlib
import pkgutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import click
import pytest
from cases import example_case
from commands import answered

from stochlin import kernels
from stochlin.kernels.basics.compiled import Entry
from stochlin.messages import WHEN_COMPILING
from stochlin.views.command import main
from stochlin.views.shared.progress import compiling_message
from stochlin.views.warmup.tasks import TASKS


def compiled() -> dict[str, int]:
    """How many kinds of arguments each function that is kept on the disk was called with."""
    kinds = {}
    for module in pkgutil.walk_packages(kernels.__path__, f"{kernels.__name__}."):
        for name, value in vars(importlib.import_module(module.name)).items():
            if isinstance(value, Entry):
                kinds[f"{value.py_func.__module__}.{name}"] = len(value.dispatcher.overloads)
    return kinds


def new_kinds(folder: Path) -> list[str]:
    """What commands call with arguments of other kinds than the tasks; in a new process."""
    for task in TASKS.values():
        task()
    before = compiled()
    assert max(before.values()) == 1  # see `variant`
    record = folder / "wave.txt"
    record.write_text("\n".join(f"{0.1 * (n % 7 - 3):g}" for n in range(100)))
    text = example_case().replace("paths = 2048", "paths = 100")
    site = f'[[site.records]]\npath = "{record.name}"\nunits = "g"\ndt = "0.02 s"\n[motion]'
    case = folder / "case.toml"
    case.write_text(text.replace("[motion]", site, 1), encoding="utf-8")
    for command in ("gap", "probability", "pound", "mitigate"):
        answered(command, case)
    return [name for name, count in compiled().items() if count != before[name]]


@pytest.mark.slow
def test_commands_need_nothing_that_the_tasks_do_not_call(tmp_path: Path) -> None:
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        assert process.submit(new_kinds, tmp_path).result() == []


def test_that_something_is_compiled_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    with compiling_message(click.Context(main)):
        for _ in range(3):
            for call in list(WHEN_COMPILING):
                call()
    assert capsys.readouterr().err.count("compiling for this machine, once") == 1
    assert not WHEN_COMPILING
