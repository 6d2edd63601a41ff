"""The house itself: imports run downwards, names are plain, public ones are documented."""

import ast
import inspect
import re
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import stochlin as sl
from stochlin.solver.variables import VARIABLES_OF_RESULTS

pytestmark = pytest.mark.invariant

ROOT = Path(sl.__file__).parent
MODULES = sorted(ROOT.rglob("*.py"))
ROOMS = tomllib.loads((Path(__file__).parent / "rooms.toml").read_text(encoding="utf-8"))
FLOORS = tuple(ROOMS)
NOT_IN_KERNELS = {"xarray", "pandas", "sympy", "matplotlib"}
PRIVATE = re.compile(r"llvmlite\b|numba\.(?!$|extending\b|(njit|config)\.$)")
# Lists, readers, and look-ups of what carries its own ``reference`` or ``source``.
WITHOUT_FORMULA = {
    *(
        "as_dictionary",
        "WhiteNoise",
        "named_ground",
        "read_case",
        "read_hazard",
        "read_modes",
        "read_pushover",
    ),
    *("read_record", "read_records", "scale_records", "read_spectrum", "simulated_motions"),
}
DOCUMENTED = {name: getattr(sl, name) for name in sorted({*sl.__all__} - {"charts", "rules"})}
PURE_NUMBERS = {"rtol", "relaxation_times"}
FIT_ANYTHING = {"one", "found", "told", "given", "asked", "meant", "doubt"}


@cache
def tree(path: Path) -> ast.Module:
    """What a file consists of."""
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path: Path) -> Iterator[str]:
    """Names of all modules that a file imports, wherever it does."""
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def room_of(parts: Sequence[str]) -> tuple[str, str]:
    """Floor and room of a module below the package; the file of a floor itself is in no room."""
    floor, room, *_ = (*parts, "", "")
    return floor, room.removesuffix(".py")


def test_rooms_import_what_is_written_down_and_in_no_circle_and_floors_only_those_below() -> None:
    """Nor does anything below the package root import that.

    A room that is not written down, such as that of a new command, may import any other on its
    floor.
    """
    arrows: dict[str, dict[str, set[str]]] = {floor: {} for floor in FLOORS}
    upwards = []
    for path in MODULES:
        floor, own = room_of(path.relative_to(ROOT).parts)
        if floor not in FLOORS:
            continue
        below = FLOORS[: FLOORS.index(floor) + 1]
        others = arrows[floor].setdefault(own, set()) if own != "__init__" else set()
        for name in (name for name in imports(path) if name.split(".")[0] == "stochlin"):
            level, room = room_of(name.split(".")[1:])
            if level == floor and room not in ("", own):
                others.add(room)
            if level == "" or (level in FLOORS and level not in below):
                upwards.append((path, name))
    written = {floor: {a: set(b) for a, b in rooms.items()} for floor, rooms in ROOMS.items()}
    assert {
        floor: {a: arrows[floor][a] for a in rooms} for floor, rooms in written.items()
    } == written
    assert upwards == []
    for rooms in arrows.values():
        assert list(TopologicalSorter(rooms).static_order())  # raises where there is a circle


def test_views_compute_nothing() -> None:
    """But for commands, which call analyses, and the warm-up, which calls what it compiles."""
    computing = []
    for path in MODULES:
        floor, room = room_of(path.relative_to(ROOT).parts)
        if floor != "views" or room == "warmup" or path.name == "command.py":
            continue
        for name in imports(path):
            level, below = room_of(name.split(".")[1:])
            allowed = {"kernels": {"basics"}, "solver": {"tables", "variables"}}.get(level)
            if allowed is not None and name.startswith("stochlin.") and below not in {"", *allowed}:
                computing.append((path, name))
    assert computing == []


def test_modules_import_one_another_in_no_circle() -> None:
    """Wherever they do: inside functions, too."""
    names = {
        path: ".".join(path.relative_to(ROOT.parent).with_suffix("").parts) for path in MODULES
    }
    names = {path: name.removesuffix(".__init__") for path, name in names.items()}
    arrows = {name: {*names.values()} & {*imports(path)} - {name} for path, name in names.items()}
    assert list(TopologicalSorter(arrows).static_order())


def test_kernels_know_no_labels_and_nothing_knows_the_inside_of_numba() -> None:
    for path in MODULES:
        names = set(imports(path))
        assert not {name for name in names if PRIVATE.match(f"{name}.")}, path
        assert not re.search(r"\b(nb|numba)\.(core|_)", path.read_text(encoding="utf-8")), path
        if path.is_relative_to(ROOT / "kernels"):
            assert not NOT_IN_KERNELS & {name.split(".")[0] for name in names}, path


def test_variables_and_arguments_have_names_that_say_what_they_are() -> None:
    named = Counter(
        f"{path.relative_to(ROOT)}: {name}"
        for path in MODULES
        for node in ast.walk(tree(path))
        if (name := getattr(node, "id", getattr(node, "arg", ""))) in FIT_ANYTHING
        and (isinstance(node, ast.arg) or isinstance(getattr(node, "ctx", None), ast.Store))
    )
    assert named == {}


def test_every_public_name_is_there_and_listed_once() -> None:
    text = (ROOT / "__init__.pyi").read_text(encoding="utf-8")
    listed = [
        alias.name for node in ast.walk(ast.parse(text)) for alias in getattr(node, "names", ())
    ]
    assert sorted(listed) == sorted(sl.__all__) == dir(sl)
    assert [name for name in listed if getattr(sl, name).__name__.rpartition(".")[2] != name] == []


@pytest.mark.slow
def test_type_checkers_and_editors_see_the_public_names(tmp_path: Path) -> None:
    snippet = tmp_path / "snippet.py"
    snippet.write_text(
        "import stochlin as sl\n"
        "reveal_type(sl.critical_gap)\nreveal_type(sl.charts.draw)\n"
        "sl.linearise\n"
        "def wrong(a: sl.Bilinear, g: sl.KanaiTajimi) -> None:\n"
        "    sl.correlate(a, a, g, method='simulated')\n"
        "    sl.amplification(a, g, of='peaks')\n"
        "    sl.Uncertain(1.0, 0.2, 'normal')\n"
        "    sl.linearize(a, g, closure='of_an_extension')\n"
        "    sl.correlate(a, a, g, method='simulation', rule='of_an_extension')\n"
    )
    # with what mypy knows already
    command = [sys.executable, "-m", "mypy", "--strict", str(snippet)]
    said = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=ROOT.parent
    ).stdout
    *lines, closing = said.splitlines()
    for text, line in zip(
        (
            "def (peak_1",
            "matplotlib.figure.Figure",
            'has no attribute "linearise"',
            "\"Literal['simulated']\"; "
            "expected \"Literal['linearization', 'white_noise', 'effective',",
            "\"Literal['peaks']\"; expected \"Literal['std', 'peak']\"",
            "\"Literal['normal']\"; expected \"Literal['lognormal', 'uniform']\"",
        ),
        lines,
        strict=True,
    ):
        assert text in line
    assert closing.startswith("Found 4 errors")


def sections(thing: object) -> dict[str, str]:
    """The sections of a numpydoc docstring, each as text; the summary has no name."""
    parts = re.split(r"^(\w+)\n-+\n", inspect.getdoc(thing) or "", flags=re.MULTILINE)
    return dict(zip(["", *parts[1::2]], parts[::2], strict=True))


def entries(parameters: str) -> list[tuple[str, str, str]]:
    """Names, kind and description of every entry in the list of parameters."""
    entry = re.compile(r"^(\S[^:\n]*?)(?: : ([^\n]*))?\n((?:[ ]+[^\n]*\n|\n)*)", re.MULTILINE)
    return entry.findall(parameters + "\n") if parameters else []


def faults_of_parameters(thing: object, text: str) -> Iterator[str]:
    """``float or array`` is a shape; ``[m]`` or ``[-]`` a unit; ``As in `other``` leads to both."""
    listed = [name.lstrip("*") for names, *_ in entries(text) for name in names.split(", ")]
    if sorted(listed) != sorted(inspect.signature(thing).parameters):  # type: ignore[arg-type]
        yield "other parameters are documented than there are"
    for names, kind, words in entries(text):
        if not (kind or re.search(r"As in `\w+`", words)):
            yield f"{names}: of what kind?"
        pure = names.startswith("**") or set(names.split(", ")) <= PURE_NUMBERS  # or of many units
        unit = re.search(r"\[[^]]+\]|[Pp]robability|Fractions|As in `\w+`", words)
        if kind.startswith("float") and not (pure or unit):
            yield f"{names}: no unit"


def faults_of_results(returned: str) -> Iterator[str]:
    """Datasets say their dimensions, and units of the variables that are named."""
    where = r"over (the dimensions|\(?``)|without dimensions|`time`"
    if returned.startswith("xarray.") and not re.search(where, returned.lower()):
        yield "no dimensions"
    for name in set(re.findall(r"``([a-z_]+)``", returned)) & set(VARIABLES_OF_RESULTS):
        units, _ = VARIABLES_OF_RESULTS[name]
        if units != "1" and f"[{units}" not in returned:
            yield f"{name} is in {units}"


def faults_of_docstring(name: str, thing: object) -> Iterator[str]:
    parts = sections(thing)
    if inspect.isclass(thing) and issubclass(
        thing, Warning
    ):  # which functions give, and no user makes
        yield from () if "Examples" in parts else ("no example",)
        return
    yield from faults_of_parameters(thing, parts.get("Parameters", ""))
    yield from faults_of_results(parts.get("Returns", ""))
    if ">>>" not in (inspect.getdoc(thing) or ""):
        yield "no example"
    if inspect.isfunction(thing) and "Returns" not in parts:
        yield "nothing on what is returned"
    parameters = inspect.signature(thing).parameters.values()  # type: ignore[arg-type]
    checks = any(str(each.annotation) != "bool" for each in parameters)  # more than a switch
    if checks and not re.search(r"^\w*(Error|Warning)", parts.get("Raises", "")):
        yield "no error is named"
    source = parts.get("References", "")  # a year, a coordinate, or a derivation of our own
    if name in WITHOUT_FORMULA:
        yield from ("it has a source: take it off the list",) if source else ()
    elif not re.search(r"\b(18|19|20)\d\d\b|coordinate|[Dd]erived here", source):
        yield "no source"


def test_public_names_say_parameters_results_errors_sources_and_an_example() -> None:
    faults = {name: list(faults_of_docstring(name, thing)) for name, thing in DOCUMENTED.items()}
    assert {name: words for name, words in faults.items() if words} == {}


@pytest.mark.parametrize(
    ("program", "unused"),
    [
        (
            "from stochlin.views.command import main; main(['--help'], standalone_mode=False)",
            {"numpy", "scipy", "xarray", "sympy", "matplotlib"},
        ),
        (
            "import stochlin as sl;"
            "sl.linearize(sl.Bilinear(1.0, .05, .05, reduction_factor=2), sl.WhiteNoise())",
            {"sympy", "matplotlib"},
        ),
    ],
    ids=["help", "linearize"],
)
def test_what_needs_a_library_alone_waits_for_it(program: str, unused: set[str]) -> None:
    code = f"{program}; import sys; print({unused} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.endswith("set()\n")
