"""The registry: found when asked for, in their order, each name once, and what is wrong is said."""

import re
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from extending import PAGE

import stochlin
from stochlin import registry as registries
from stochlin.models.contacts.elements import CONTACTS, Contact
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import GROUNDS, Ground
from stochlin.models.rules.codes import CODE_RULES, CodeRule
from stochlin.models.structures import LAWS, Structure
from stochlin.registry import GROUP, Registry, import_extensions
from stochlin.views.shared.screen import COMMANDS

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
    with pytest.raises(
        ValueError, match=r"kind = 'other' is not a known thing; allowed: one_thing$"
    ):
        registry.named("other", "kind")


def test_a_file_that_cannot_be_imported_is_named_and_the_others_still_work(folder):
    """Where warnings are errors, whoever asks next is told, too."""
    (folder / "broken.py").write_text("def half(:\n")
    (folder / "missing.py").write_text("import nowhere_to_be_found\n")
    registry = Registry("thing", "some_kind")
    registry.register("useful")(object())
    for _ in range(2):
        with pytest.raises(
            UserWarning, match=r"some_kind\.broken is not used, .*SyntaxError.*line 1"
        ):
            list(registry)
    with pytest.warns(UserWarning, match=r"some_kind\.") as messages:
        assert list(registry) == ["useful"]
    assert len(messages) == 2


def test_a_module_of_a_folder_needs_no_other_file(folder):
    (folder / "new").mkdir()
    (folder / "new" / "thing.py").write_text("")
    (folder / "new" / "other.py").write_text("import nowhere_to_be_found\n")
    assert not Registry("thing", "some_kind", "thing")
    assert "some_kind.new.thing" in sys.modules


def test_the_page_has_every_registry_and_names_files_that_are_there():
    page, sources = (
        PAGE.read_text(encoding="utf-8"),
        [*Path(stochlin.__file__).parent.rglob("*.py")],
    )
    texts = [path.read_text(encoding="utf-8") for path in sources]
    kinds = {
        name for text in texts for name in re.findall(r"^(\w+): Registry\[", text, re.MULTILINE)
    }
    assert len(kinds) >= 13
    assert {
        kind for kind in kinds if not re.search(rf"^\| .*\b{kind}`", page, re.MULTILINE)
    } == set()
    named = set(re.findall(r"`(?:[\w/]*/)?(\w+\.(?:py|toml))`", page))
    assert len(named) >= 7
    assert named <= {path.name for path in sources}


class NoFilter(Ground):
    name = "none"


class NoName(Ground):
    @staticmethod
    def filter(values): ...


class NoRates(Structure): ...


class NoTimes(Envelope): ...


class NoRestitution(Contact): ...


@pytest.mark.parametrize(
    ("registry", "wrong", "says"),
    [
        (GROUNDS, NoFilter, "NoFilter has no filter, which a class of Ground needs"),
        (GROUNDS, NoName, "NoName has no name, which"),
        (LAWS, NoRates, "NoRates has no symbolic, which"),
        (ENVELOPES, NoTimes, "NoTimes has no at, which"),
        (CONTACTS, NoRestitution, "NoRestitution has no e, which"),
        (LAWS, len, ".*len.* is registered; allowed: a class derived from Structure"),
        (COMMANDS, len, "command .*len.*; allowed: a function below @click.command"),
        (
            CODE_RULES,
            CodeRule(name="atlantis", reference="7.3", gap_of=lambda site: 0.01 * site.height_1),
            "atlantis: the formula fails with both peaks alone; name what else it takes in needs",
        ),
        (
            CODE_RULES,
            CodeRule(
                name="atlantis", reference="7.3", gap_of=lambda site: site.number * site.peak_1
            ),
            "atlantis: the formula fails with both peaks alone; .* or by a number",
        ),
    ],
)
def test_what_lacks_what_its_kind_needs_is_refused(registry, wrong, says):
    with pytest.raises(ValueError, match=f"^{says}"):
        registry.register("wrong")(wrong)
    assert "wrong" not in registry


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
        ({"needs": "zone"}, r"needs = 'zone'; allowed: a tuple, as \('zone',\)"),
        ({"countries": "Chile"}, "countries = 'Chile'; allowed: a tuple"),
        ({"called": "factor R"}, "called = 'factor R'; allowed: names by factor"),
        ({"called": {"q": "factor q"}}, "called = 'q'; allowed: 'behaviour', "),
        ({"multiplies": "behaviour"}, "called has no 'behaviour', which"),
    ],
)
def test_a_code_rule_that_declares_what_does_not_exist_is_refused(declared, says):
    with pytest.raises(ValueError, match=f"^atlantis: {says}"):
        CodeRule(**{"name": "atlantis", "reference": "7.3", "gap_of": max} | declared)
