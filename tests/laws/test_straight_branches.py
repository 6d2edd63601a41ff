"""The modified Clough and flag-shaped laws: branch by branch, their work, oscillators with them."""

import numpy as np
import pytest
from loops import by_steps, random_turns

import stochlin as sl

pytestmark = pytest.mark.oracle

GROUND = sl.KanaiTajimi(0.4, 0.6, 0.02)
GIVEN = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}
CRACKS = {"cracking": 0.4, "uncracked_stiffness": 2.5}
CAPPED = {"cap_ductility": 2.0, "softening": 0.3, "residual": 0.25}
LAWS = [
    *(sl.ModifiedClough(**GIVEN, unloading_exponent=a) for a in (0.0, 0.4, 0.8)),
    *(sl.Flag(**GIVEN, beta=beta) for beta in (0.0, 0.6, 1.0)),
    sl.ModifiedClough(**GIVEN, **CRACKS),
    sl.ModifiedClough(**GIVEN, **CAPPED),
    sl.ModifiedClough(**GIVEN, **CRACKS, **CAPPED | {"residual": 0.8}, unloading_exponent=0.0),
    sl.ModifiedClough(**GIVEN, **CRACKS, **CAPPED | {"residual": 0.0, "cap_ductility": 1.0}),
]


class Clough:
    """The law from branch to branch: ``z`` after ``mu`` has moved to another value."""

    def __init__(self, structure):
        given = structure.cells()
        self.a, self.z, self.mu, self.zero = given["unloading_exponent"], 0.0, 0.0, 0.0
        self.first = (1.0, 1.0)
        if "cracking" in given:
            self.first = given["cracking"] / given["uncracked_stiffness"], given["cracking"]
        self.corners = [(0.0, 0.0), self.first, (1.0, 1.0)]
        if "cap_ductility" in given:
            cap, least = given["cap_ductility"], given["residual"]
            self.corners += [(cap, 1.0), (cap + (1.0 - least) / given["softening"], least)]
        self.corners += [(1e9, self.corners[-1][1])]
        self.peaks = {1: self.first[0], -1: self.first[0]}

    def backbone(self, size):
        return np.interp(size, *zip(*self.corners, strict=True))

    def move(self, end):
        s = 1 if end > self.mu else -1
        while self.mu != end:
            stiffness, event = self.branch(s)
            reached = end if s * (end - event) <= 0 else event
            self.z += stiffness * (reached - self.mu)
            self.mu = reached
            if abs(self.z) < 1e-14:
                self.z, self.zero = 0.0, self.mu
        self.peaks[s] = max(self.peaks[s], s * self.mu)
        if self.peaks[s] > 1.0:  # the other side is cracked, too
            self.peaks[-s] = max(self.peaks[-s], 1.0)

    def unloading(self, s):
        """A chord to the point of cracking on the other side, and weaker after yielding."""
        peak = min(self.peaks[s], 1.0)
        chord = (self.backbone(peak) + self.first[1]) / (peak + self.first[0])
        return chord * max(self.peaks[s], 1.0) ** -self.a

    def branch(self, s):
        """Its stiffness, and the mu at which it ends."""
        if s * self.z < 0:
            stiffness = self.unloading(-s)
            return stiffness, self.mu - self.z / stiffness
        peak = s * self.peaks[s]
        if s * (self.mu - peak) >= -1e-14:
            corner = next(x for x, _ in self.corners if x > s * self.mu + 1e-12)
            rise = self.backbone(corner) - self.backbone(s * self.mu)
            return rise / (corner - s * self.mu), s * corner
        way = self.backbone(self.peaks[s]) / (self.peaks[s] - s * self.zero)
        on_the_way = way * (self.mu - self.zero)
        if abs(on_the_way - self.z) < 1e-13:
            return way, peak
        stiffness = self.unloading(s)
        return stiffness, self.mu + (on_the_way - self.z) / (stiffness - way)


class FlagShaped:
    """The same, in closed form on each side of 0."""

    def __init__(self, structure):
        self.low, self.z, self.mu = 1 - float(structure.beta), 0.0, 0.0

    def move(self, end):
        if self.mu * end < 0:
            self.move(0.0)
        side = np.sign(self.mu or end)
        before, after, z = abs(self.mu), abs(end), abs(self.z)
        if after > before:
            z = min(z + after - before, 1.0)
        else:
            z = max(z - before + after, min(self.low, after))
        self.mu, self.z = end, side * z


def by_branches(structure):
    return (Clough if isinstance(structure, sl.ModifiedClough) else FlagShaped)(structure)


def own_of(structure):
    return [float(array) for array in structure.law_parameters()]


@pytest.mark.parametrize("structure", LAWS, ids=lambda one: one.describe()[:8] + str(own_of(one)))
@pytest.mark.parametrize("pieces", [1, 7])
def test_states_along_random_histories(structure, pieces):
    turns = random_turns(3, 40, 30)
    found, _ = by_steps(structure.step(), turns, pieces, own_of(structure))
    for lane in range(turns.shape[1]):
        law = by_branches(structure)
        for n in range(1, len(turns)):
            law.move(turns[n, lane])
            assert found[n, 0, lane] == pytest.approx(law.z, abs=1e-10)
    assert (np.abs(found[:, 0]) <= 1.0 + 1e-12).all()


@pytest.mark.parametrize(
    "structure", [LAWS[1], LAWS[4], LAWS[8]], ids=["modified Clough", "flag", "backbone"]
)
def test_an_oscillator_on_a_record_follows_central_differences(structure):
    """In steps of 1/5000 period, whose error is some 1e-6, with the law from branch to branch."""
    w, xi, alpha = 2 * np.pi / GIVEN["period"], GIVEN["damping"], GIVEN["hardening"]
    uy, law = GIVEN["yield_displacement"], by_branches(structure)
    record = sl.simulated_motions(GROUND, 5.0, paths=2, seed=3)[0]
    time = record.time.to_numpy()
    cuts = round((time[1] - time[0]) / (GIVEN["period"] / 5000))
    dt = (time[1] - time[0]) / cuts
    ground = np.interp(time[0] + dt * np.arange(cuts * (time.size - 1)), time, record)
    u = before = peak = 0.0
    for a in ground:
        pull = -a - alpha * w**2 * u - (1 - alpha) * w**2 * uy * law.z
        after = (2 * u - before + xi * w * dt * before + dt**2 * pull) / (1 + xi * w * dt)
        u, before = after, u
        law.move(u / uy)
        peak = max(peak, abs(u))
    table = sl.respond(structure, record)
    assert peak > 2 * uy
    np.testing.assert_allclose(np.abs(table.displacement).max(), peak, rtol=5e-4)
    np.testing.assert_allclose(table.displacement[-1], u, rtol=0, atol=5e-4 * peak)
    np.testing.assert_allclose(table.z[-1], law.z, rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    ("kind", "changed", "message"),
    [
        (sl.ModifiedClough, {"unloading_exponent": 1.0}, "allowed: 0 <= value < 1"),
        (
            sl.ModifiedClough,
            CAPPED | {"cap_ductility": 0.9},
            "allowed: 1 <= value, .*not before yield",
        ),
        (sl.ModifiedClough, CAPPED | {"residual": 1.0}, "allowed: 0 <= value < 1, .*1 at the cap"),
        (sl.ModifiedClough, {"cracking": 0.4}, "cracking is given without uncracked_stiffness"),
        (sl.ModifiedClough, {"softening": 0.4}, "softening is given without cap_ductility"),
        (
            sl.ModifiedClough,
            CAPPED | {"softening": 0.11},
            r"no descending branch.*0\.111111 < value",
        ),
        (sl.Flag, {"beta": 1.1}, "allowed: 0 <= value <= 1"),
    ],
    ids=str,
)
def test_branches_that_do_not_fit_together_are_refused(kind, changed, message):
    with pytest.raises(ValueError, match=message):
        kind(**GIVEN, **changed)


def test_a_crack_along_the_elastic_line_or_a_cap_out_of_reach_change_nothing():
    plain = sl.ModifiedClough(**GIVEN)
    for changed in (
        {"cracking": 0.3, "uncracked_stiffness": 1.0},
        CAPPED | {"cap_ductility": 50.0},
    ):
        structures = [plain, sl.ModifiedClough(**GIVEN, **changed)]
        table = sl.simulate(structures, GROUND, paths=32, duration=6.0)
        assert float(table.peak.min()) > GIVEN["yield_displacement"]
        np.testing.assert_allclose(*table.peak.values.T, rtol=1e-9)


def test_the_flag_has_a_stationary_response_but_no_coefficients():
    one = sl.Flag(**GIVEN)
    table = sl.simulate([one], GROUND, paths=32, relaxation_times=1.0)
    assert float(table.displacement_std[0]) > 0
    with pytest.raises(ArithmeticError, match=r"Flag cannot be linearized.*with a duration"):
        sl.linearize(one, GROUND)
