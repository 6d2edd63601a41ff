"""The registry: found when asked for, in their order, each name once, and what is wrong is said."""

import sys

import pytest

from stochlin.registry import Registry

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
