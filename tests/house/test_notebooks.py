"""Every notebook runs from top to bottom, without warnings of the library."""

from collections.abc import Iterator
from pathlib import Path

import nbformat
import pytest
from jupyter_client.client import KernelClient
from jupyter_client.manager import start_new_kernel
from nbclient import NotebookClient

pytestmark = pytest.mark.cli

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))

# All run in one kernel, which forgets what the one before has defined and set.
BEGIN = """%reset -f
import warnings; warnings.simplefilter('error')
import matplotlib; matplotlib.rcdefaults()
%matplotlib inline"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[KernelClient]:
    manager, client = start_new_kernel(cwd=str(NOTEBOOKS[0].parent))
    yield client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::DeprecationWarning:zmq", "ignore::RuntimeWarning:zmq")
def test_notebook_runs(path: Path, kernel: KernelClient) -> None:
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell(BEGIN))
    runner = NotebookClient(notebook, kernel.parent, timeout=300)
    runner.kc = kernel
    runner.execute()
    assert all(cell.source.strip() for cell in notebook.cells)
