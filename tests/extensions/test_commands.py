"""Commands from outside: one file, listed and run by the command line."""

import pytest

import stochlin as sl

pytestmark = pytest.mark.invariant


@pytest.mark.slow
def test_the_example_of_the_page_is_listed_and_runs(toy):
    listed = toy("--help")
    assert listed.returncode == 0, listed.stderr
    assert "The standard deviation of a structure on white noise." in listed.stdout
    assert "Draw all design charts" in listed.stdout
    assert "stochlin toy --period 1.5" in toy("toy", "--help").stdout
    done = toy("toy", "--period", 1.5)
    expected = sl.linearize(sl.Bilinear(1.5, 0.05), sl.WhiteNoise(0.01)).displacement_std
    assert done.stdout == f"{float(expected):.4g} m\n"
    wrong = toy("toy", "--period", -1)
    assert wrong.returncode == 2
    assert "period = -1 is" in wrong.stderr
