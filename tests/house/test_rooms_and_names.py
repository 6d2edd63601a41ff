"""The house itself: imports run downwards, public names are there and documented, nothing prints."""

import ast
import inspect
import re
import runpy
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import stochlin as sl

pytestmark = pytest.mark.invariant

ROOT = Path(sl.__file__).parent
MODULES = sorted(ROOT.rglob("*.py"))
KERNELS = [path for path in MODULES if path.relative_to(ROOT).parts[0] == "kernels"]
ROOMS = tomllib.loads((Path(__file__).parent / "rooms.toml").read_text(encoding="utf-8"))
FLOORS = tuple(ROOMS)
MOST_MODULES = 12  # of a folder
# Lists, readers, and look-ups of what carries its own ``reference`` or ``source``.
WITHOUT_FORMULA = {
    "WhiteNoise",
    "named_ground",
    "read_case",
    "read_hazard",
    "read_modes",
    "read_pushover",
    "read_record",
    "read_records",
    "scale_records",
    "read_spectrum",
    "simulated_motions",
}
VARIABLES = [
    (name, units)
    for path in sorted(ROOT.glob("analyses/*/variables.py"))
    for name, (units, _) in runpy.run_path(str(path))["VARIABLES"].items()
]
UNITS = dict(VARIABLES)
CALLABLE = sorted({*sl.__all__} - {"charts", "rules"})
PURE_NUMBERS = {"rtol", "atol", "relaxation_times"}


def imports(path: Path) -> Iterator[str]:
    """Names of all modules that a file imports, wherever it does."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def room_of(parts: Sequence[str]) -> tuple[str, str]:
    """Floor and room of a module below the package; the file of a floor itself is in no room."""
    floor, room, *_ = (*parts, "", "")
    return floor, room.removesuffix(".py")


def test_every_module_is_in_a_room() -> None:
    places = {room_of(path.relative_to(ROOT).parts) for path in MODULES}
    found = {floor: {room for f, room in places if f == floor} - {"__init__"} for floor in FLOORS}
    assert found == {floor: set(rooms) for floor, rooms in ROOMS.items()}


@pytest.mark.parametrize("floor", FLOORS)
def test_rooms_import_one_another_as_written_down_and_in_no_circle(floor: str) -> None:
    arrows: dict[str, set[str]] = {room: set() for room in ROOMS[floor]}
    for path in (ROOT / floor).rglob("*.py"):
        _, own = room_of(path.relative_to(ROOT).parts)
        for name in imports(path):
            other, room = room_of(name.removeprefix("stochlin.").split("."))
            if name.startswith("stochlin.") and other == floor and room not in ("", own):
                arrows[own].add(room)
    assert arrows == {room: set(others) for room, others in ROOMS[floor].items()}
    assert list(TopologicalSorter(arrows).static_order())  # raises where there is a circle


def test_folders_are_seen_at_a_glance() -> None:
    folders = Counter(path.parent for path in MODULES if path.name != "__init__.py")
    assert {folder: n for folder, n in folders.items() if n > MOST_MODULES} == {}


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_run_downwards(path: Path) -> None:
    """Nor does anything below the package root import that."""
    floor = path.relative_to(ROOT).parts[0]
    if floor not in FLOORS:
        return
    above = FLOORS[FLOORS.index(floor) + 1 :]
    names = [name for name in imports(path) if name.split(".")[0] == "stochlin"]
    assert not [name for name in names if name == "stochlin" or name.split(".")[1] in above]


@pytest.mark.parametrize("path", KERNELS, ids=lambda p: str(p.relative_to(ROOT)))
def test_kernels_know_no_labels(path: Path) -> None:
    assert not {"xarray", "pandas", "sympy", "matplotlib"} & {
        name.split(".")[0] for name in imports(path)
    }


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_only_public_names_of_numba_are_used(path: Path) -> None:
    private = re.compile(r"llvmlite\b|numba\.(?!$|extending\b|(njit|config)\.$)")
    assert not [name for name in imports(path) if private.match(f"{name}.")]
    assert not re.search(r"\b(nb|numba)\.(core|_)", path.read_text(encoding="utf-8"))


def test_every_public_name_is_there_and_listed_once() -> None:
    text = (ROOT / "__init__.pyi").read_text(encoding="utf-8")
    listed = [alias.name for node in ast.walk(ast.parse(text)) for alias in getattr(node, "names", ())]
    assert sorted(listed) == sorted(sl.__all__) == dir(sl)
    assert [name for name in listed if getattr(sl, name).__name__.rpartition(".")[2] != name] == []


@pytest.mark.slow
def test_type_checkers_and_editors_see_the_public_names(tmp_path: Path) -> None:
    snippet = tmp_path / "snippet.py"
    snippet.write_text(
        "import stochlin as sl\n"
        "reveal_type(sl.critical_gap)\nreveal_type(sl.charts.draw)\n"
        "sl.linearise\n"
    )
    command = [sys.executable, "-m", "mypy", "--strict", str(snippet)]  # with what mypy knows already
    found = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=ROOT.parent
    ).stdout.splitlines()
    assert "def (peak_1" in found[0]
    assert "matplotlib.figure.Figure" in found[1]
    assert 'has no attribute "linearise"' in found[2]


@pytest.mark.parametrize("name", CALLABLE)
def test_public_names_are_documented(name: str) -> None:
    thing = getattr(sl, name)
    text = inspect.getdoc(thing) or ""
    assert ">>>" in text, "no example"
    for parameter in inspect.signature(thing).parameters:
        assert parameter in text, f"{parameter} is not documented"
    if inspect.isfunction(thing):
        assert "Returns" in text


def sections(name: str) -> dict[str, str]:
    """The sections of a numpydoc docstring, each as text; the summary has no name."""
    parts = re.split(r"^(\w+)\n-+\n", inspect.getdoc(getattr(sl, name)) or "", flags=re.MULTILINE)
    return dict(zip(["", *parts[1::2]], parts[::2], strict=True))


def entries(name: str) -> list[tuple[str, str, str]]:
    """Names, kind and description of every entry in the list of parameters."""
    entry = re.compile(r"^(\S[^:\n]*?)(?: : ([^\n]*))?\n((?:[ ]+[^\n]*\n|\n)*)", re.MULTILINE)
    return entry.findall(sections(name).get("Parameters", "") + "\n")


@pytest.mark.parametrize("name", CALLABLE)
def test_public_names_say_shape_and_unit_of_their_numbers(name: str) -> None:
    """``float or array`` is a shape; ``[m]`` or ``[-]`` a unit; ``As in `other``` leads to both."""
    listed = ", ".join(names for names, _, _ in entries(name)).split(", ") if entries(name) else []
    listed = [one.lstrip("*") for one in listed]
    assert sorted(listed) == sorted(inspect.signature(getattr(sl, name)).parameters)
    for names, kind, text in entries(name):
        if re.search(r"As in `\w+`", text):
            continue
        assert kind, f"{names}: of what kind?"
        if names.startswith("**"):
            continue  # of many units, told where they are declared
        if kind.startswith("float") and not set(names.split(", ")) <= PURE_NUMBERS:
            assert re.search(r"\[[^]]+\]|[Pp]robability|Fractions", text), f"{names}: no unit"


@pytest.mark.parametrize("name", CALLABLE)
def test_public_names_say_dimensions_and_units_of_their_datasets(name: str) -> None:
    returned = sections(name).get("Returns", "")
    if returned.startswith("xarray."):
        assert re.search(r"over (the dimensions|\(?``)|without dimensions|`time`", returned.lower())
    for variable in set(re.findall(r"``([a-z_]+)``", returned)) & set(UNITS):
        units = UNITS[variable]
        assert units == "1" or f"[{units}" in returned, f"{variable} is in {units}"


def test_a_variable_has_the_same_unit_in_every_room() -> None:
    assert len(UNITS) > 100
    assert {name for name, units in VARIABLES if units != UNITS[name]} == set()


@pytest.mark.parametrize("name", CALLABLE)
def test_public_names_say_what_they_raise(name: str) -> None:
    """All that takes more than a switch checks it."""
    parameters = inspect.signature(getattr(sl, name)).parameters.values()
    if any(str(p.annotation) != "bool" for p in parameters):
        assert re.search(r"^\w*(Error|Warning)", sections(name).get("Raises", "")), "no error is named"


@pytest.mark.parametrize("name", CALLABLE)
def test_public_names_say_where_their_formulas_come_from(name: str) -> None:
    """A source has a year, or is a coordinate or a derivation of our own."""
    source = sections(name).get("References", "")
    if name in WITHOUT_FORMULA:
        assert not source, "it has a source: take it off the list"
    else:
        assert re.search(r"\b(18|19|20)\d\d\b|coordinate|[Dd]erived here", source), "no source"


def test_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'linearise'"):
        _ = sl.linearise  # type: ignore[attr-defined]


def test_start_of_the_command_line_waits_for_no_library() -> None:
    heavy = ("numpy", "scipy", "xarray", "sympy", "matplotlib")
    program = (
        "import sys; from stochlin.views.command import main; main(['--help'], standalone_mode=False);"
        f"print([m for m in {heavy} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("[]\n")


def test_solving_needs_neither_sympy_nor_matplotlib() -> None:
    program = (
        "import sys, stochlin as sl;"
        "sl.linearize(sl.Bilinear(1.0, .05, .05, reduction_factor=2), sl.WhiteNoise());"
        "print([m for m in ('sympy', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
