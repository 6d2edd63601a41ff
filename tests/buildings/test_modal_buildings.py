"""Buildings by their modes: as chains of storeys, against closed forms; what is wrong is said."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.messages import DoubtfulInput
from stochlin.models.systems import stick_model_of

pytestmark = pytest.mark.invariant

GROUND = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.02)
TALL = sl.ShearBuilding(
    [2e5, 2e5, 2e5, 1.5e5], [4e8, 3.6e8, 3e8, 2.2e8], heights=[3.5] * 4, damping=0.05
)
LOW = sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], heights=[3.5] * 2, damping=0.05)
WEAK = sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], [3.0, 4.2], 0.05, 0.1, 0.006)  # floors not level
RECORDS = sl.simulated_motions(GROUND, 4.0, paths=2, seed=1)
BUMPER = sl.Kelvin(1e9, restitution=0.65)
TIE = sl.Link(stiffness=1e8, damping_constant=1e6, floors=(2, 2))
SHORT = {"duration": 4.0, "paths": 32}
TWO: dict[str, Any] = {
    "periods": [0.5, 0.18],
    "shapes": [[0.62, 1.0], [-1.61, 1.0]],
    "masses": [2e5, 2e5],
    "heights": [3.5, 3.5],
    "damping": 0.05,
}


def modes_of(building: sl.ShearBuilding, count: int | None = None) -> dict[str, Any]:
    """Its modes by numpy, with shapes of any size and sign."""
    values = {name: array.to_numpy() for name, array in building.arrays().items()}
    drifts = np.eye(building.storeys) - np.eye(building.storeys, k=-1)
    stiffness = drifts.T @ np.diag(values["stiffnesses"]) @ drifts
    root = np.sqrt(values["masses"])
    squares, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    sizes = np.array([3.0, -0.2, 1.0, 7.0])[: squares.size]
    kept = slice(count)
    return {
        "periods": (2 * np.pi / np.sqrt(squares))[kept],
        "shapes": (sizes[:, None] * (vectors / root[:, None]).T)[kept],
        "masses": values["masses"],
        "heights": values["heights"],
        "damping": building.damping,
    }


BY_MODES = sl.ModalBuilding(**modes_of(TALL))

ANALYSES: dict[str, Callable[[Any], xr.Dataset]] = {
    "linearize_system, linked": lambda b: sl.linearize_system([b, WEAK], GROUND, [TIE]),
    "simulate, linked": lambda b: sl.simulate([b, WEAK], GROUND, link=TIE, **SHORT),
    "recorded_gap": lambda b: sl.recorded_gap(b, WEAK, RECORDS[0]).drop_vars("step_error"),
}


OF_ROUNDING = "covariance", "covariance_change", "coefficient_change"


def assert_same(one: xr.Dataset, other: xr.Dataset, rtol: float) -> None:
    assert set(one.data_vars) == set(other.data_vars)
    for name, array in one.drop_vars(OF_ROUNDING, errors="ignore").data_vars.items():
        if array.dtype.kind in "fiu":
            size = float(np.abs(array.where(np.isfinite(array))).max())
            np.testing.assert_allclose(
                other[name].values, array.values, rtol=0, atol=rtol * size, err_msg=str(name)
            )


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ANALYSES)
def test_all_modes_of_an_elastic_chain_are_the_chain(analysis: str) -> None:
    of = ANALYSES[analysis]
    assert_same(of(TALL), of(BY_MODES), 1e-9)


@pytest.mark.parametrize("analysis", ANALYSES)
def test_buildings_may_have_fewer_modes_than_floors_or_more(analysis: str) -> None:
    """Three modes of four floors, and the same with each as two halves of its mass side by side."""
    of, values = ANALYSES[analysis], modes_of(TALL, 3)
    three = sl.ModalBuilding(**values)
    halves = {name: np.repeat(values[name], 2, axis=0) for name in ("periods", "shapes")}
    parts = {"participation": three.factors(), "modal_masses": three.effective_masses()}
    halves |= {name: np.repeat(part / 2, 2) for name, part in parts.items()}
    assert_same(of(three), of(sl.ModalBuilding(**values | halves)), 1e-9)


@pytest.mark.parametrize(
    ("contact", "motions"), [(BUMPER, RECORDS), (sl.Stereomechanical(0.6), RECORDS[0])]
)
def test_all_modes_of_an_elastic_chain_pound_like_the_chain(contact: Any, motions: Any) -> None:
    """Up to the tolerance of a time step's passes, 1e-8, over a few hundred steps with contact."""
    second, kind = (WEAK, BUMPER) if contact is BUMPER else (LOW, contact)
    chain, modes = (sl.pound([b, second], 0.01, kind, motions) for b in (TALL, BY_MODES))
    assert chain.impacts.max() > 0
    names = ["energy_balance_error", "step_error", "end_state"]  # the last is of coordinates
    assert_same(*(table.drop_vars(names, errors="ignore") for table in (chain, modes)), 1e-7)
    errors = (float(table.energy_balance_error.max()) for table in (chain, modes))
    assert next(errors) == pytest.approx(next(errors), rel=1e-3, abs=1e-9)


def test_one_mode_that_yields_is_the_yielding_oscillator() -> None:
    """Displacements are those of the oscillator times the floors' moves; so is its ductility."""
    strength = {"hardening": 0.1, "yield_displacements": 0.01}
    stiff = sl.ShearBuilding([2e5, 1e5, 4e5], [4e8, 9e8, 4e8], [3.0] * 3, 0.05)
    one = sl.ModalBuilding(**modes_of(stiff, 1), **strength)
    first, moves = one.oscillator(), one.first_mode_moves().to_numpy()
    assert (first.hardening, first.yield_displacement) == (0.1, 0.01)
    building, oscillator = (sl.simulate([s], GROUND, **SHORT) for s in (one, first))
    peaks = oscillator.peak.values
    np.testing.assert_allclose(building.peak.values, peaks * np.abs(moves), rtol=1e-9)
    of_mode = building.sel(element="mode 1.1")
    np.testing.assert_allclose(of_mode.peak_drift, peaks[:, 0], rtol=1e-9)
    assert float(of_mode.ductility) > 1
    assert np.isnan(building.ductility.sel(element=["1.1", "1.2", "1.3"])).all()


def test_the_time_step_follows_modes_that_yield_or_move_the_building() -> None:
    """The third mode moves the roof by a thousandth of the first one only, if it stays elastic."""
    shapes = [[0.094, 0.331, 0.65, 1.0], [-0.565, -1.082, -0.495, 1.0], [1.729, 0.529, -1.648, 1.0]]
    wall: dict[str, Any] = {"periods": [0.72, 0.118, 0.03], "shapes": shapes, "heights": [3.4] * 4}
    wall |= {"masses": [3e5, 3e5, 3e5, 2.2e5], "damping": 0.05}
    device = sl.Link(damping_constant=1e6, structures=(1, 1), floors=(4, 0))
    for strengths, link, followed in (
        (None, None, 0.118),
        ([0.045], None, 0.118),
        ([0.045, 0.002, 0.001], None, 0.03),
        (None, device, 0.118),
    ):
        hardening = None if strengths is None else 0.05
        building = sl.ModalBuilding(**wall, hardening=hardening, yield_displacements=strengths)
        table = sl.simulate([building], GROUND, link=link, duration=1.0, paths=32)
        assert table.attrs["step_s"] == pytest.approx(followed / 32, rel=0.01)


@pytest.mark.parametrize("law", [{}, {"law": "bouc_wen", "law_parameters": {"beta": 0.7}}])
def test_modes_yield_side_by_side(law: dict[str, Any]) -> None:
    """Two modes are the oscillators of both under the same motions, with the strength of each."""
    strengths, hardening = np.array([0.008, 0.002]), np.array([0.1, 0.3])
    values = modes_of(TALL)
    building = sl.ModalBuilding(**values, hardening=hardening, yield_displacements=strengths, **law)
    kind = sl.BoucWen if law else sl.Bilinear
    own = law.get("law_parameters", {})
    oscillators: list[Any] = [
        kind(period, 0.05, h, yield_displacement=y, **own)
        for period, h, y in zip(values["periods"], hardening, strengths, strict=False)
    ]
    oscillators += [sl.Bilinear(period, 0.05) for period in values["periods"][2:]]
    motion = RECORDS[0]
    table = sl.respond(building, motion)
    moves = stick_model_of(building).system.shapes
    alone = np.stack([sl.respond(o, motion).displacement.values for o in oscillators], axis=1)
    size = np.abs(table.displacement.values).max()
    # Records are taken in steps that are halved until peaks move by less than 1e-4.
    np.testing.assert_allclose(table.displacement.values, alone @ moves.T, atol=1e-3 * size)
    linear = sl.linearize_system([building], GROUND)
    both = [sl.linearize(o, GROUND) for o in oscillators[:2]]
    np.testing.assert_allclose(
        linear.ductility_std[-2:], [float(one.ductility_std) for one in both], rtol=1e-6
    )
    space = sl.statespace([building], GROUND, linear.c_eq.values, linear.k_eq.values)
    np.testing.assert_allclose(
        sl.stationary_covariance(space), linear.covariance, rtol=1e-6, atol=1e-12
    )


def test_a_corner_that_turns_takes_the_numbers_of_its_program() -> None:
    """Given participation factors and masses equal to those computed change only known shears."""
    given = {"participation": BY_MODES.factors(), "modal_masses": BY_MODES.effective_masses()}
    corner = sl.ModalBuilding(**modes_of(TALL), **given)
    one, other = (sl.pound([b], motion=RECORDS[0]) for b in (BY_MODES, corner))
    np.testing.assert_allclose(other.peak, one.peak, rtol=1e-12)
    np.testing.assert_allclose(other.peak_base_shear, one.peak_base_shear, rtol=1e-12)
    assert np.isnan(other.peak_storey_shear[0, 1:]).all()
    assert np.isfinite(one.peak_storey_shear).all()


def test_floors_follow_the_ground_where_modes_are_left_out() -> None:
    """With one mode that moves all floors by .3 of its oscillator, .7 of the ground is left."""
    values = modes_of(TALL, 1) | {"shapes": np.ones((1, 4))}
    with pytest.warns(DoubtfulInput, match=r"have 13\.3% of the mass"):
        rest = sl.ModalBuilding(**values, participation=[0.3], modal_masses=[1e5])
    of_floors = sl.pound([rest], motion=RECORDS[0]).acceleration.values[:, 0]
    alone = sl.pound([rest.oscillator()], motion=RECORDS[0]).acceleration.values[:, 0]
    ground = RECORDS[0].values
    for floor in of_floors.T:
        np.testing.assert_allclose(floor, 0.3 * alone + 0.7 * ground, atol=1e-9 * np.ptp(ground))


def test_modes_that_are_exchanged_are_asked_about() -> None:
    """A slower mode across the gap has little of the mass along it, and may have a node."""
    with pytest.warns(
        sl.ImplausibleInput, match="mode 1 has a node and a longer period than mode 2"
    ):
        sl.ModalBuilding(**TWO | {"shapes": TWO["shapes"][::-1]})
    across = {"participation": [0.05, 1.24, 0.2], "modal_masses": [4e3, 3.6e5, 2e4]}
    shapes = [[-0.4, 1.0], *TWO["shapes"]]
    sl.ModalBuilding(**TWO | across | {"shapes": shapes, "periods": [0.7, *TWO["periods"]]})


def test_uncertain_periods_scale_all_modes() -> None:
    values = modes_of(TALL)
    uncertain = sl.ModalBuilding(**values | {"periods": sl.Uncertain(values["periods"], 0.0)})
    one, other = (sl.simulate([b], GROUND, **SHORT) for b in (BY_MODES, uncertain))
    np.testing.assert_allclose(other.peak, one.peak, rtol=1e-9)


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "unit of a list": (
        {"masses": xr.DataArray([200.0, 100.0], dims="floor", attrs={"units": "t"})},
        "masses is in 't', by its attribute units; allowed: kg",
    ),
    "not orthogonal": ({"shapes": [[0.62, 1.0], [1.0, 1.0]]}, r"1 and 2 are not orthogonal: 0\.97"),
    "frequencies": ({"periods": [2.0, 5.5]}, r"modes 1 and 2 are 2 and 5\.5 s; .*longest first"),
    "too many": (
        {"shapes": [[1.0, 1.0]] * 601, "periods": [1.0] * 601},
        r"has 601 values; .* at most 600 modes",
    ),
    "participation alone": ({"participation": [1.0, 0.3]}, r"participation or modal_masses alone"),
    "ratios": (
        {"participation": [1.0, 0.3], "modal_masses": [5e5, 2e4]},
        r"are 1\.3 of the masses",
    ),
    "across the gap": (
        {"participation": [1.0, 0.3], "modal_masses": [4e5, 1e-3]},
        r"2 does not move",
    ),
    "still": ({"shapes": [[0.62, 1.0], [0.0, 0.0]]}, r"shapes of mode 2 are all 0"),
    "uncertain shapes": ({"shapes": sl.Uncertain([[0.6, 1.0]], 0.1)}, r"shapes is uncertain"),
    "parameters of the law": (
        {
            **{"yield_displacements": [0.01, 0.01], "hardening": [0.1, 0.5]},
            **{
                "law": "modified_clough",
                "law_parameters": {"softening": 0.2, "cap_ductility": 4.0},
            },
        },
        r"law_parameters = .*softening.*; allowed: what fits the hardening",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_with_modes_is_said(case: str) -> None:
    values, message = WRONG[case]
    with pytest.raises((ValueError, TypeError), match=message):
        sl.ModalBuilding(**TWO | values)
