"""The same pounding pairs in OpenSeesPy: oscillators, and frames of unequal storeys, all of Steel01."""

import numpy as np
import pytest
from motions import smooth_noise
from opensees_models import add_oscillators, add_shear_building, new_model, shake

import stochlin as sl

pytestmark = pytest.mark.oracle

PERIODS, DAMPING, HARDENING = (1.1, 0.5), 0.05, 0.05
MASSES, YIELD = (2e5, 3e5), (0.03, 0.015)  # [kg], [m]
GAP, STIFFNESS = 0.001, 5e7  # [m], [N/m]
DT, STEP = 0.02, 0.0002  # of the record, of OpenSees
PEAK_SHARE = 0.01  # of the peak: its contacts begin and end at steps


def record(samples=800):
    rise = np.sin(np.pi * np.arange(samples) / (samples - 1))
    return 1.5 * smooth_noise(samples, 85, 15, DT) * rise


def peaks_in_opensees(ops, acceleration, damper):
    """Largest displacements of the pair; compression, and with it the gap, is negative there."""
    new_model(ops)
    tops = add_oscillators(ops, PERIODS, MASSES, YIELD, DAMPING, HARDENING)
    if damper:
        ops.uniaxialMaterial("ViscoelasticGap", 9, STIFFNESS, damper, -GAP)
    else:
        ops.uniaxialMaterial("ElasticPPGap", 9, STIFFNESS, -1e12, -GAP, 0.0)
    ops.element("zeroLength", 9, *tops, "-mat", 9, "-dir", 1)
    shake(ops, acceleration, DT, ("NormDispIncr", 1e-12, 50))
    most = np.zeros(2)
    for _ in range(round((len(acceleration) - 1) * DT / STEP)):
        assert ops.analyze(1, STEP) == 0
        most = np.maximum(most, [abs(ops.nodeDisp(top, 1)) for top in tops])
    return most


@pytest.mark.parametrize("kind", ["spring", "kelvin"])
def test_peaks_of_a_pounding_pair_are_those_of_opensees(ops, kind):
    contact = sl.LinearSpring(STIFFNESS)
    if kind == "kelvin":
        contact = sl.Kelvin(STIFFNESS, restitution=0.65)
    pair = [
        sl.Bilinear(period, DAMPING, hardening=HARDENING, yield_displacement=uy, mass=mass)
        for period, mass, uy in zip(PERIODS, MASSES, YIELD, strict=True)
    ]
    motion = record()
    table = sl.pound(pair, GAP, contact, motion)
    assert table.sizes["impact"] >= 3
    assert (table.peak > YIELD).all()
    assert (abs(table.amplification - 1) > 2 * PEAK_SHARE).any()  # the contact is felt
    reduced = MASSES[0] * MASSES[1] / sum(MASSES)
    damper = float(contact.force_law(reduced).damping)
    theirs = peaks_in_opensees(ops, motion.to_numpy(), damper)
    np.testing.assert_allclose(table.peak, theirs, rtol=PEAK_SHARE)


FIVE = sl.ShearBuilding(
    [2.2e5] * 5, np.linspace(4e8, 1.6e8, 5), [3.5] * 5, 0.05, 0.05, np.linspace(0.009, 0.006, 5)
)
EIGHT = sl.ShearBuilding(
    [3e5] * 8, np.linspace(3.6e8, 1.1e8, 8), [3.5] * 8, 0.05, 0.03, np.linspace(0.012, 0.008, 8)
)
SPRING = 5e8  # [N/m]


def histories_in_opensees(ops, acceleration, gap):
    """Displacements (times, floors) of both frames; without a gap they stand far apart."""
    new_model(ops)
    floors = [add_shear_building(ops, 100 * b, each) for b, each in enumerate((FIVE, EIGHT), start=1)]
    if gap is not None:
        ops.uniaxialMaterial("ElasticPPGap", 1, SPRING, -1e15, -gap, 0.0)
        for i, sides in enumerate(zip(*floors, strict=False)):
            ops.element("zeroLength", 50_000 + i, *sides, "-mat", 1, "-dir", 1)
    shake(ops, acceleration, DT, ("NormDispIncr", 1e-10, 50), "RCM", "BandGeneral")
    tags = [tag for each in floors for tag in each]
    found = [np.zeros(13)]
    for _ in range(len(acceleration) - 1):
        assert ops.analyze(round(DT / STEP), STEP) == 0
        found.append([ops.nodeDisp(floor, 1) for floor in tags])
    return np.array(found)


@pytest.mark.parametrize("gap", [None, 0.01])
def test_histories_of_frames_are_those_of_opensees(ops, gap):
    motion = 2 * record(500)
    table = sl.pound([FIVE, EIGHT], gap or 10.0, sl.LinearSpring(SPRING), motion)
    assert (table.sizes["impact"] > 5) == (gap is not None)
    assert float(table.hysteretic_energy[-1].min()) > 0
    ours = np.concatenate([table.displacement[:, 0, :5], table.displacement[:, 1]], axis=1)
    theirs = histories_in_opensees(ops, motion.to_numpy(), gap)
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-4 * abs(ours).max())
