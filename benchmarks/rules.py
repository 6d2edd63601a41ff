"""Error of rules for the gap of yielding pairs, in motions of 30 s: `python benchmarks/rules.py`.

The gap is that of `stochlin.separation`: the quantile of max(u_1 - u_2) at a confidence of 90 %,
with the stiffer structure on the left. The motions have an Amin-Ang envelope (4 s, 15 s, 0.35);
hardening 0.02, 0.05 and 0.1; T1/T2 from 0.3 to 0.9; three T2 around the period of the ground. Takes
some minutes.
"""

import numpy as np
import xarray as xr

import stochlin as sl

QUAKE = sl.AminAng(4.0, 15.0, 0.35)
DURATION, CONFIDENCE = 30.0, 0.9
PATHS = 16384  # for standard errors of gaps of 2 % at most, and of their mean far less
HARDENING = xr.DataArray([0.02, 0.05, 0.1], dims="hardening")
RATIOS = xr.DataArray([0.3, 0.5, 0.7, 0.8, 0.9], dims="ratio")
# Each with the periods of the second structure [s].
GROUNDS = {
    "broad band": (sl.KanaiTajimi(2 * np.pi / 15, 0.6, 1e-3), [0.3, 0.6, 1.2]),
    "lake bed": (sl.KanaiTajimi(2.0, 0.05, 1e-3), [0.5, 1.0, 2.0]),
}
FACTORS = (2, 4, 6)
SIMULATED = "eq_3_simulated"
# Rules of `separation`, and eq. (3) with the simulated correlation, as the table names them.
RULES = {
    "first_passage_drift": "none: first passage by the drift closure in time",
    "eq_3_elastic": "elastic, eq. (4)",
    "eq_3_secant": "secant",
    "eq_3_penzien_1997": "secant at 0.65 of the ductility (Penzien 1997)",
    "eq_3_iwan_1980": "Iwan 1980",
    "eq_3_fema_440": "FEMA-440",
    "eq_3_linearized": "linearization",
    "eq_3_drift": "the drift closure in time",
    "srss": "0 (SRSS)",
    "share_of_sum": "-1 (sum)",
    SIMULATED: "simulation",
    "eq_3_paper": "linearization, with elastic peaks times $D$ (the paper)",
}


def errors(ground, factor, periods, paths=PATHS):
    """Gap over the simulated minus 1, by rule, of all pairs, and the latter's standard error."""
    period = xr.DataArray(periods, dims="period")
    first = sl.Bilinear(RATIOS * period, 0.05, HARDENING, reduction_factor=factor)
    second = sl.Bilinear(period, 0.05, HARDENING, reduction_factor=factor)
    table = sl.separation(
        first,
        second,
        ground,
        DURATION,
        envelope=QUAKE,
        confidence=CONFIDENCE,
        scatter=0.0,
        paths=paths,
    )
    needed = table.gap.sel(rule="simulation", drop=True)
    rho = sl.correlate(first, second, ground, "simulation").rho
    of_simulated = sl.critical_gap(table.peak_1, table.peak_2, rho).gap / needed - 1
    by_rule = table.error.reset_coords(drop=True)
    all_rules = xr.concat([by_rule, of_simulated.expand_dims(rule=[SIMULATED])], "rule")
    interval = (table.gap_upper - table.gap_lower).sel(rule="simulation", drop=True)
    return all_rules.sel(rule=list(RULES)), interval / (2 * 1.96 * needed)


def results():
    """Errors and standard errors of `errors`, by ground and R."""
    return {
        f"{name}, R = {factor}": errors(ground, factor, periods)
        for name, (ground, periods) in GROUNDS.items()
        for factor in FACTORS
    }


def in_words(percent):
    """Mean (least to largest), without a sign of zeros."""
    numbers = percent.mean(), percent.min(), percent.max()
    mean, least, largest = (f"{round(float(number)) + 0:+d}" for number in numbers)
    return f"{mean} ({least} to {largest})"


def table(by_case):
    """Rows by rule, columns by ground and R: mean (least to largest) error in %."""
    lines = [["$\\rho$ by", *by_case], ["---"] * (1 + len(by_case))]
    for rule, text in RULES.items():
        percent = [100 * error.sel(rule=rule) for error, _ in by_case.values()]
        lines.append([text, *map(in_words, percent)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


if __name__ == "__main__":
    by_case = results()
    print(table(by_case))
    largest = max(float(error.max()) for _, error in by_case.values())
    print(f"standard error of a gap: at most {100 * largest:.1f} %")
