"""Every notebook runs from top to bottom, without warnings of the library."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from cases import with_slow
from nbclient import NotebookClient

pytestmark = pytest.mark.cli

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", with_slow(NOTEBOOKS, NOTEBOOKS[1:]), ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::DeprecationWarning:zmq", "ignore::RuntimeWarning:zmq")
def test_notebook_runs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.insert(
        0, nbformat.v4.new_code_cell("import warnings; warnings.simplefilter('error')")
    )
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    assert all(cell.source.strip() for cell in notebook.cells)


def test_there_are_notebooks() -> None:
    assert NOTEBOOKS
