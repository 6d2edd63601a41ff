"""Error of the CQC of a difference against simulation: `python benchmarks/modes.py`.

30 random pairs of 3 to 10 storeys, elastic and yielding at R of 1.5 to 6, in motions of 30 s under an
Amin-Ang envelope (4 s, 15 s, 0.35). Beside the rule `cqc` stand the root of squares and the sum of the
CQC of each building, and rules with simulated peaks. Errors are those of the gap with a confidence of
0.9 over the simulated one, in per cent: in the mean, in nine of ten pairs, and at worst.
"""

import numpy as np

import stochlin as sl
from stochlin.analyses.linearization.equivalent_systems import solve_elastic
from stochlin.analyses.linearization.peaks import response_moments
from stochlin.analyses.separation.modes import combine_modes, modes_of, oscillators_of
from stochlin.analyses.separation.pairs import peak_quantile
from stochlin.analyses.separation.storeys import facing_heights, weights_at
from stochlin.models.envelopes import strong_seconds
from stochlin.models.systems import arrangement_of

QUAKE = sl.AminAng(4.0, 15.0, 0.35)
DURATION, CONFIDENCE, PATHS, PAIRS = 30.0, 0.9, 512, 30
GROUNDS = ("firm", "soft")
RULES = ("cqc", "srss", "share_of_sum", "eq_3_linearized", "linearization")


def drawn(rng):
    """A building, its R, and how uneven its stiffnesses are."""
    storeys = int(rng.integers(3, 11))
    period, factor = storeys * 0.1 * np.exp(rng.normal(0, 0.25)), np.exp(rng.uniform(*np.log([1.5, 6])))
    height, damping, hardening = (rng.uniform(*ends) for ends in ((2.8, 4), (0.02, 0.06), (0.02, 0.1)))
    regular = sl.ShearBuilding.regular(
        period=period,
        storeys=storeys,
        storey_height=height,
        mass=3e5,
        damping=damping,
        hardening=hardening,
        base_shear_coefficient=0.1,
    )
    return regular, factor, rng.uniform(0.85, 1.15, storeys)


def building(regular, factor, uneven, ground):
    """The building, which yields in its first mode at 3 standard deviations over R, if there is one."""
    values = {name: array.to_numpy() for name, array in regular.arrays().items()}
    common = values["masses"], values["stiffnesses"] * uneven, values["heights"], regular.damping
    if factor is None:
        return sl.ShearBuilding(*common)
    drifts = np.broadcast_to(values["yield_drifts"], uneven.shape)
    first = sl.ShearBuilding(*common, regular.hardening, drifts).oscillator()
    std = float(sl.linearize(sl.Bilinear(first.period, first.damping), ground).displacement_std)
    return sl.ShearBuilding(
        *common, regular.hardening, drifts * 3 * std / factor / first.yield_displacement
    )


def own_peaks(pair, ground):
    """CQC of each building [m] at the heights at which they could meet."""
    system = arrangement_of(pair)
    modes = modes_of(system)
    moments = response_moments(solve_elastic(oscillators_of(modes), ground), ground)
    peaks = peak_quantile(moments, strong_seconds(DURATION, QUAKE), CONFIDENCE, sides=2).values
    return combine_modes(modes, peaks, ground, weights_at(system, facing_heights(system)))[0]


def errors(pair, ground):
    motion = {"envelope": QUAKE, "confidence": CONFIDENCE, "paths": PATHS, "seed": 1}
    table = sl.separation(*pair, ground, DURATION, **motion)
    peaks, gaps = own_peaks(pair, ground), table.gap.to_series()
    found = {rule: gaps[rule] for rule in RULES}
    found |= {"root of both CQC": np.hypot(*peaks).max(), "sum of both CQC": peaks.sum(axis=0).max()}
    held = float(table.no_pounding_probability.sel(rule="cqc"))
    return {rule: 100 * (gap / gaps["simulation"] - 1) for rule, gap in found.items()} | {"held": held}


def main():
    for name in GROUNDS:
        ground = sl.named_ground(name, intensity=0.01)
        for yields in (False, True):
            rng = np.random.default_rng(1)
            pairs = [(drawn(rng), drawn(rng)) for _ in range(PAIRS)]
            rows = [
                errors([building(b, r if yields else None, k, ground) for b, r, k in pair], ground)
                for pair in pairs
            ]
            print(f"{name}, {'yielding' if yields else 'elastic'}")
            for rule in rows[0]:
                of_rule = np.array([row[rule] for row in rows])
                ends = *np.quantile(of_rule, [0.05, 0.95]), of_rule.min(), of_rule.max()
                print(f"  {rule:18s}" + "".join(f"{value:8.2f}" for value in (of_rule.mean(), *ends)))


if __name__ == "__main__":
    main()
