"""Every module of the house keeps within its aim or its last size."""

import pytest
from house.lines import BUDGETS, budgets, sizes

pytestmark = pytest.mark.invariant

WRITTEN = budgets(BUDGETS.read_text(encoding="utf-8"))


def test_everything_keeps_within_the_larger_of_its_aim_and_its_last_size() -> None:
    now = sizes()
    assert set(WRITTEN) == set(now)
    above = {name: now[name] for name, allowed in WRITTEN.items() if now[name] > max(allowed)}
    assert above == {}, f"write less; tests/house/{BUDGETS.name} has what they may have"
