"""Names of variables: every room has its own, and nothing gets the meaning of another."""

import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.correlation.variables import VARIABLES as OF_PAIRS
from stochlin.analyses.linearization.variables import VARIABLES as OF_ONE
from stochlin.analyses.tables import labels

pytestmark = pytest.mark.invariant


def told(names, variables):
    table = labels.label(xr.Dataset(dict.fromkeys(names, 1.0)), variables)
    return {name: table[name].attrs.get("long_name") for name in names}


def test_a_name_goes_before_its_number_and_its_ends():
    own = {"width": ("m", "width"), "width_2": ("m", "the other width")}
    found = told(["width", "width_1", "width_2", "width_lower", "width_best", "height"], own)
    assert found["width_1"] == "width, structure 1"
    assert found["width_2"] == "the other width"
    assert found["width_lower"] == "width, lower end of the 95 % interval"
    assert found["width_best"] is None
    assert found["height"] is None


def test_bias_of_a_pair_is_of_rho_and_of_each_structure_of_its_standard_deviation():
    pair, one = told(["bias", "bias_1"], OF_PAIRS), told(["bias"], OF_ONE)
    assert pair["bias"] == "bias of rho: linearized minus simulated"
    assert pair["bias_1"] == f"{one['bias']}, structure 1"


def test_the_flag_of_the_permanent_set_is_not_a_length():
    one, two = (sl.Bilinear(period, 0.05) for period in (0.6, 1.0))
    ground, envelope = sl.WhiteNoise(0.01), sl.AminAng(4.0, 15.0, 0.35)
    flag = sl.pounding_probability(
        one, two, ground, 0.1, paths=0, duration=25.0, envelope=envelope
    ).permanent_set
    assert "units" not in flag.attrs
    assert "envelope finally below" in flag.attrs["long_name"]
    assert len(flag.attrs["flag_meanings"].split()) == len(flag.attrs["flag_values"])


def test_every_variable_and_coordinate_of_gaps_in_records_has_a_unit_and_a_long_name():
    pair = [sl.Bilinear(period, 0.05) for period in (0.6, 1.0)]
    motions = sl.simulated_motions(sl.WhiteNoise(0.01), 5.0, paths=2)
    table = sl.recorded_gap(*pair, list(motions))
    assert table["quantile"].attrs == {"units": "1", "long_name": "quantile"}
    bare = [name for name, array in table.variables.items() if "long_name" not in array.attrs]
    numbers = [name for name, array in table.variables.items() if array.dtype.kind == "f"]
    assert not bare
    assert all("units" in table[name].attrs for name in numbers)
