"""What a user describes can be sent to another process, compared and used as a key."""

import inspect
import pickle
from pathlib import Path
from typing import Any

import pytest
from cases import example_case
from house.test_wrong_values import NAMES, arguments
from uploads import open_case

import stochlin as sl
from stochlin.charts import ChartSettings
from stochlin.models.rules.codes import CODE_RULES
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES
from stochlin.models.rules.peak_factors import PEAK_FACTORS

pytestmark = pytest.mark.invariant

UNHASHABLE = {"Case", "ModalBuilding", "ShearBuilding"}  # they hold arrays and mappings


def things(folder: Path) -> list[Any]:
    """An object of every public class, and all rules."""
    kinds = {name: getattr(sl, name) for name in NAMES if inspect.isclass(getattr(sl, name, None))}
    made = [kind(**arguments(name, folder)) for name, kind in kinds.items() if name != "Case"]
    case, _ = open_case({"case.toml": example_case().encode()})
    rules = [
        rule for rules in (CODE_RULES, EFFECTIVE_RULES, PEAK_FACTORS) for rule in rules.values()
    ]
    return [*made, *rules, case, ChartSettings()]


def test_a_copy_is_the_same(tmp_path: Path) -> None:
    for thing in things(tmp_path):
        other = pickle.loads(pickle.dumps(thing))
        assert type(other) is type(thing)
        if type(thing).__name__ in UNHASHABLE:
            assert repr(other) == repr(thing)
        else:
            assert other == thing
            assert hash(other) == hash(thing)


def test_a_law_that_was_sent_away_gives_the_same_numbers(tmp_path: Path) -> None:
    friction = sl.Hysteretic(**arguments("Hysteretic", tmp_path))
    sent = pickle.loads(pickle.dumps(friction))
    ground = sl.KanaiTajimi(1.0, 0.3)
    for law in (friction, sent):
        law.step()
    assert sl.linearize(sent, ground).equals(sl.linearize(friction, ground))
    assert pickle.loads(pickle.dumps(friction)) == friction  # after its compiled parts were used
