"""Names of variables and their endings have units and long names; no dimension takes a name."""

import numpy as np
import pytest
import xarray as xr
from cases import with_slow

import stochlin as sl
from stochlin.solver.tables import labels

pytestmark = pytest.mark.invariant


def test_a_name_goes_before_its_endings_and_a_special_name_before_both():
    names = [
        "rho",
        "rho_1",
        "gap",
        "gap_lower",
        "peak_mean_standard_error_2",
        "record_rho",
        "rho_best",
    ]
    table = labels.label(xr.Dataset(dict.fromkeys(names, 1.0)), {"gap_lower": ("m", "smaller gap")})
    found = {name: table[name].attrs.get("long_name") for name in names}
    rho = "correlation coefficient of the displacements"
    assert found["rho_1"] == f"{rho}, structure 1"
    assert found["record_rho"] == f"{rho}, in the record"
    assert found["gap_lower"] == "smaller gap"
    peak = "standard error of the mean of the peak absolute displacement, structure 2"
    assert found["peak_mean_standard_error_2"] == peak
    assert table.peak_mean_standard_error_2.units == "m"
    assert found["rho_best"] is None


def test_every_variable_and_coordinate_of_gaps_in_records_has_a_unit_and_a_long_name():
    pair = [sl.Bilinear(period, 0.05) for period in (0.6, 1.0)]
    motions = sl.simulated_motions(sl.WhiteNoise(0.01), 5.0, paths=2)
    table = sl.recorded_gap(*pair, list(motions))
    assert table["quantile"].attrs == {"units": "1", "long_name": "quantile"}
    bare = [name for name, array in table.variables.items() if "long_name" not in array.attrs]
    numbers = [name for name, array in table.variables.items() if array.dtype.kind == "f"]
    assert not bare
    assert all("units" in table[name].attrs for name in numbers)


GROUND = sl.WhiteNoise(0.01)
RECORD = sl.simulated_motions(GROUND, 4.0, paths=2)[0]
QUAKE = {"duration": 1.2, "envelope": sl.AminAng(0.4, 0.8, 0.5)}
OTHER = sl.Bilinear(0.8, 0.05, 0.05, yield_displacement=0.05)
NAMED = {
    "rho": {
        "correlate": lambda one: sl.correlate(one, OTHER, GROUND),
        "eq. (4)": lambda one: sl.rho_white_noise(one.period, 1.0, 0.05, 0.05),
        "system": lambda one: sl.linearize_system([one, OTHER], GROUND),
        "recorded_gap": lambda one: sl.recorded_gap(one, OTHER, RECORD),
        "probability": lambda one: sl.pounding_probability(
            one, OTHER, GROUND, 0.1, paths=0, **QUAKE
        ),
    },
    "status": {
        "linearize": lambda one: sl.linearize(one, GROUND),
        "critical_gap": lambda one: sl.critical_gap(one.period, 0.1, 0.3),
        "amplification": lambda one: sl.amplification(one, GROUND),
        "transient_response": lambda one: sl.transient_response(one, GROUND, **QUAKE),
        "response_spectrum": lambda one: sl.response_spectrum(RECORD, one.period, 0.05),
        "separation": lambda one: sl.separation(one, OTHER, GROUND, paths=32, **QUAKE),
    },
    "floor": {"system": lambda one: sl.linearize_system([one], GROUND)},
    "time": {"transient_response": lambda one: sl.transient_response(one, GROUND, **QUAKE)},
    "displacement_std_1": {"correlate": lambda one: sl.correlate(one, OTHER, GROUND)},
}
CASES = [(name, verb) for name, verbs in NAMED.items() for verb in verbs]


@pytest.mark.parametrize("with_labels", with_slow([True, False], [False]))
@pytest.mark.parametrize(("name", "verb"), CASES)
def test_a_dimension_has_no_name_of_the_result(name, verb, with_labels):
    periods = np.array([0.5, 1.0])
    array = xr.DataArray(periods, dims=name, coords={name: periods} if with_labels else None)
    one = sl.Bilinear(array, 0.05, 0.05, yield_displacement=0.05)
    with pytest.raises(ValueError, match=f"a dimension is named '{name}'.*another name"):
        NAMED[name][verb](one)


@pytest.mark.parametrize("name", with_slow(["reduction_factor", "period", "gap"], ["period"]))
def test_a_dimension_may_have_the_name_of_a_parameter(name):
    factors = xr.DataArray([3.0, 4.0], coords={name: [3.0, 4.0]})
    pair = [sl.Bilinear(period, 0.05, 0.05, reduction_factor=factors) for period in (0.6, 1.0)]
    for table in (
        sl.linearize_system(pair, GROUND),
        sl.transient_response(pair[0], GROUND, **QUAKE),
        sl.pounding_probability(*pair, GROUND, 0.1, **QUAKE, paths=0),
    ):
        assert table.sizes[name] == 2
