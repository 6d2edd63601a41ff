"""The registry: found when asked for, in their order, each name once, and what is wrong is said."""

import sys
from importlib.metadata import EntryPoint

import pytest

from stochlin import registry as registries
from stochlin.models.rules.codes import CodeRule
from stochlin.registry import GROUP, Registry, import_extensions

pytestmark = pytest.mark.invariant


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty package; modules written into it are found."""
    package = tmp_path / "some_kind"
    package.mkdir()
    (package / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    yield package
    for name in [name for name in sys.modules if name.split(".")[0] == "some_kind"]:
        del sys.modules[name]


def test_a_file_in_the_folder_is_an_extension(folder):
    registry = Registry("thing", "some_kind")
    sys.modules["some_kind_registry"] = type(sys)("some_kind_registry")
    sys.modules["some_kind_registry"].registry = registry
    source = "from some_kind_registry import registry\n@registry.register({!r})\nclass Thing: ...\n"
    for name in ("second", "first"):
        (folder / f"{name}.py").write_text(source.format(name))
    assert "some_kind.first" not in sys.modules
    assert list(registry) == ["first", "second"]
    assert registry.named(" First ").__module__ == "some_kind.first"
    del sys.modules["some_kind_registry"]


@pytest.mark.usefixtures("folder")
def test_place_goes_before_name_and_a_name_is_given_once():
    registry = Registry("thing", "some_kind")
    registry.register("zulu", place=1)(object())
    registry.register("alpha")(object())
    registry.register("mike", place=2)(object())
    assert list(registry) == ["zulu", "mike", "alpha"]
    with pytest.raises(ValueError, match="thing 'mike' exists already"):
        registry.register("mike")(object())


@pytest.mark.usefixtures("folder")
def test_an_unknown_name_lists_those_that_are_known():
    registry = Registry("thing", "some_kind")
    registry.register("one_thing")(1)
    assert registry.named("ONE-thing") == 1
    with pytest.raises(ValueError, match=r"kind = 'other' is not a known thing; allowed: one_thing$"):
        registry.named("other", "kind")


def test_what_cannot_be_imported_is_told_each_time_that_it_is_asked_for(folder):
    (folder / "broken.py").write_text("import nowhere_to_be_found\n")
    registry = Registry("thing", "some_kind")
    for _ in range(2):
        with pytest.raises(ModuleNotFoundError, match="nowhere_to_be_found"):
            list(registry)


def test_an_extension_that_is_wrong_is_named_and_the_others_still_work(folder, monkeypatch):
    """One that cannot be imported, and one whose name is taken."""
    registry = Registry("thing", "some_kind")
    registry.register("taken")(object())
    sys.modules["some_kind_registry"] = type(sys)("some_kind_registry")
    sys.modules["some_kind_registry"].registry = registry
    register = "from some_kind_registry import registry\nregistry.register({!r})(object())\n"
    sources = {"broken": "import nowhere_to_be_found\n"}
    sources |= {name: register.format(name) for name in ("taken", "useful")}
    (folder / "__init__.py").write_text("__path__ = []\n")  # nothing of its own
    for name, source in sources.items():
        (folder.parent / f"toy_{name}.py").write_text(source)
    entries = [EntryPoint(name, f"toy_{name}", GROUP) for name in sources]
    monkeypatch.setattr(registries, "entry_points", lambda group: entries)
    import_extensions.cache_clear()
    try:
        with pytest.warns(UserWarning, match="is not used") as messages:
            assert list(registry) == ["taken", "useful"]
    finally:
        import_extensions.cache_clear()
        for name in [*sources, "kind_registry"]:
            sys.modules.pop(f"toy_{name}", None)
            sys.modules.pop(f"some_{name}", None)
    assert [str(each.message).split(" (")[0] for each in messages] == [
        "the extension 'broken'",
        "the extension 'taken'",
    ]
    assert "No module named 'nowhere_to_be_found'" in str(messages[0].message)
    assert "thing 'taken' exists already; choose another name" in str(messages[1].message)


@pytest.mark.parametrize(
    ("declared", "says"),
    [
        ({"gap_of": None}, "gap_of is not given; allowed: a function of a Site"),
        ({"family": "srss"}, "family = 'srss'; allowed: '', 'SRSS', 'sum'"),
        ({"between": "both"}, "between = 'both'; allowed: "),
        ({"needs": ("height",)}, "needs = 'height'; allowed: .*'height_1'"),
        (
            {"multiplies": "ductility"},
            "multiplies = 'ductility'; allowed: '', 'behaviour', 'deflection'",
        ),
        ({"called": {"q": "factor q"}}, "called = 'q'; allowed: 'behaviour', "),
        ({"multiplies": "behaviour"}, "called has no 'behaviour', which"),
    ],
)
def test_a_code_rule_that_declares_what_does_not_exist_is_refused(declared, says):
    with pytest.raises(ValueError, match=f"^atlantis: {says}"):
        CodeRule(**{"name": "atlantis", "reference": "7.3", "gap_of": max} | declared)
