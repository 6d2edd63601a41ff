"""The estimate of pounding from energies, beside simulation: `python benchmarks/pounding_estimates.py`.

Random rows of structures of each kind, each in two motions of its own: 12 s on firm ground. Periods 0.3
to 2 s, masses within a factor of ten; buildings of 3 to 10 equal storeys of one height, of 0.07 to 0.13
s a storey; strength a quarter of the elastic demand; gaps 0.05 to 0.4 of the root of the summed squares
of the energy radii; contacts of e = 0.65. Some minutes.
"""

import sys
from dataclasses import replace

import numpy as np

import stochlin as sl

GROUND = sl.named_ground("firm", intensity=0.01)
QUAKE = {"duration": 12.0, "envelope": sl.AminAng(2.0, 8.0, 0.5)}
CONTACT = sl.Kelvin(5e8, restitution=0.65)
BUMPER = sl.Kelvin(5e8, restitution=0.3)
KINDS = {
    (name, yields): (count, storeys, yields)
    for name, count, storeys in (
        ("two oscillators", 2, False),
        ("two buildings with storeys", 2, True),
        ("three oscillators", 3, False),
        ("three buildings with storeys", 3, True),
    )
    for yields in (False, True)
}
ROWS, MOTIONS = 60, 2
YIELDS = {False: "elastic", True: "yielding"}


def structure(rng, storeys):
    if not storeys:
        period = np.exp(rng.uniform(np.log(0.3), np.log(2.0)))
        return sl.Bilinear(period, 0.05, mass=1e6 * 10 ** rng.uniform(-0.5, 0.5))
    count = int(rng.integers(3, 11))
    return sl.ShearBuilding.regular(
        period=count * rng.uniform(0.07, 0.13),
        storeys=count,
        storey_height=3.5,
        mass=1e5 * 10 ** rng.uniform(0.0, 0.6),
        damping=0.05,
    )


def oscillator_of(one):
    """The first mode, and how far the roof moves."""
    if isinstance(one, sl.ShearBuilding):
        return one.oscillator(), float(one.participation()[-1])
    return one, 1.0


def row(rng, count, storeys, yields):
    """Structures, gaps [m] and motions."""
    motions = sl.simulated_motions(GROUND, **QUAKE, paths=MOTIONS, seed=int(rng.integers(2**31)))
    found, reach = [], []
    for _ in range(count):
        one = structure(rng, storeys)
        mode, roof = oscillator_of(one)
        radius = np.mean(
            [float(sl.pseudo_energy_radius(m, mode.period, 0.05).pseudo_energy_radius) for m in motions]
        )
        reach.append(roof * radius)
        if yields:
            name = "yield_drifts" if storeys else "yield_displacement"
            uy = radius / 4 * (roof / one.storeys if storeys else 1.0)
            one = replace(one, hardening=0.05, **{name: uy})
        found.append(one)
    gaps = [rng.uniform(0.05, 0.4) * np.hypot(*reach[n : n + 2]) for n in range(count - 1)]
    return found, gaps, motions


def logarithms(kind, rows, seed):
    """ln(estimate/truth) over rows, structures, motions, one hit and chain, displacement and radius."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(rows):
        structures, gaps, motions = row(rng, *KINDS[kind])
        error = sl.pounding_estimate_error(structures, gaps, CONTACT, motions)
        told = [error.largest_radius_amplification, error.chain_radius_amplification]
        true = [error.peak_amplification, error.peak_radius_amplification]
        logs = [[np.log(t / a).where(error.hits > 0).values.T for a in true] for t in told]
        found.append(np.transpose(logs, (2, 3, 0, 1)))
    return np.array(found)


def figures(logs):
    """Bias with its standard error, scatter, and share exceeded with its standard error.

    Errors are from the scatter between rows: what is in one row is not independent.
    """
    each = logs.reshape(len(logs), -1)
    each = each[np.isfinite(each).any(axis=1)]
    more = np.where(np.isnan(each), np.nan, each < 0)
    rows = np.nanmean(each, axis=1), np.nanmean(more, axis=1)
    errors = [values.std(ddof=1) / np.sqrt(values.size) for values in rows]
    known = each[np.isfinite(each)]
    return known.mean(), errors[0], known.std(ddof=1), (known < 0).mean(), errors[1]


def effect_of_bumper(kind, rows, seed):
    """Means over structures and motions, row by row, of what a bumper changes: the truth, the estimate.

    As logarithms of the largest displacement, and of the estimate of one hit, with it over without.
    """
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(rows):
        structures, gaps, motions = row(rng, *KINDS[kind])
        with_it, without = (
            sl.pounding_estimate_error(structures, gaps, contact, motions)
            for contact in (BUMPER, CONTACT)
        )
        hit = ((with_it.hits > 0) & (without.hits > 0)).values
        if hit.any():
            names = ("peak_amplification", "largest_radius_amplification")
            changes = [np.log(with_it[name] / without[name]).values[hit] for name in names]
            found.append([*(change.mean() for change in changes), changes[1].max()])
    return np.array(found)


def main():
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else ROWS
    for kind in KINDS:
        logs = logarithms(kind, rows, seed=1)
        for estimate, name in enumerate(("one hit", "chain")[: 1 + kind[0].startswith("three")]):
            for of, what in enumerate(("displacement", "radius")):
                bias, se, scatter, share, error = figures(logs[..., estimate, of])
                shown = f"bias {bias:+.3f} ({se:.3f}), scatter {scatter:.2f}"
                shown += f", exceeded {share:.3f} ({error:.3f})"
                print(f"{kind[0]}, {YIELDS[kind[1]]}, {name}, {what}: {shown}", flush=True)
    for yields in (False, True):
        changes = effect_of_bumper(("two oscillators", yields), rows, seed=2)
        error = changes.std(axis=0, ddof=1) / np.sqrt(len(changes))
        for name, change, own in zip(("truth", "estimate"), changes.mean(axis=0), error, strict=False):
            print(f"bumper of e = .3, {YIELDS[yields]}, {name}: {change:+.3f} ({own:.3f})", flush=True)


if __name__ == "__main__":
    main()
