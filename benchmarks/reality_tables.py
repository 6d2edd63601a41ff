"""What the gaps that `reality.py` tried say: shares that held, their intervals, scatter, tables."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import scipy.stats
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import OTHER_COMPONENT, SCATTER_OF_SPECTRUM

NOMINAL = (0.5, 0.84, 0.9, 0.95)
CURVE = np.union1d(NOMINAL, np.arange(0.05, 0.99, 0.05).round(2))
EDGES = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)  # of predicted probabilities
GRID = np.arange(0, 0.805, 0.01)  # of scatter
DRAWS, TAIL = 2000, 0.025
SPECTRUM, OWN_COMPONENT, OTHER = "spectrum", "own component", "other component"
BOTH, PGA_ELSEWHERE, SA_ELSEWHERE = "both components", "elsewhere by PGA", "elsewhere by Sa"
SA_ELSEWHERE_BOTH = f"{SA_ELSEWHERE}, {BOTH}"
USUAL, AFTER = SCATTER_OF_SPECTRUM.scatter, OTHER_COMPONENT.scatter
LEVELS = (0.0, USUAL)  # of scatter
FITTED = -1.0  # in place of a scatter: that of the fit to both components
CONFIDENCE = 0.9  # of the gaps by rule, and of both components
FAR_FIELD, LAKE_BED = "far field", "lake bed"
SUITES = (FAR_FIELD, LAKE_BED)
KNOWN_PLACE = tuple((part, suite) for part in (SPECTRUM, OTHER) for suite in SUITES)


# --- counting
# -----------------------------------------------------------------------------------------


def share_interval(came_true: Array, place: Array) -> tuple[float, float, float]:
    """Share of what came true (case, ...) and its 95 % interval; cases of a place go together.

    Clopper and Pearson's interval of the number of independent cases that would scatter as much as
    the places do (Korn and Graubard 1998); where all came true or none, each place is one case. NaN
    in ``came_true`` was not tried.
    """
    rows = np.reshape(came_true, (len(place), -1))
    _, group = np.unique(place, return_inverse=True)
    tried = np.bincount(group, (~np.isnan(rows)).sum(axis=1))
    hits = np.bincount(group, np.nansum(rows, axis=1))[tried > 0]
    tried = tried[tried > 0]
    total, places = tried.sum(), tried.size
    share = hits.sum() / total
    if share in (0, 1) or places < 2:
        effective = float(places)
    else:
        variance = places / (places - 1) * ((hits - share * tried) ** 2).sum() / total**2
        ratio = scipy.stats.t.ppf(1 - TAIL, [total - 1, places - 1])
        with np.errstate(divide="ignore"):
            effective = share * (1 - share) / variance * (ratio[0] / ratio[1]) ** 2
        effective = min(float(effective), float(total))
    count = share * effective
    lower = scipy.stats.beta.ppf(TAIL, count, effective - count + 1)
    upper = scipy.stats.beta.ppf(1 - TAIL, count + 1, effective - count)
    return float(share), float(np.nan_to_num(lower, nan=0.0)), float(np.nan_to_num(upper, nan=1.0))


def held(rank: xr.DataArray, nominal: float) -> Array:
    """1 where the gap of this nominal share was enough, NaN where none was tried."""
    return np.where(np.isnan(rank), np.nan, rank <= nominal)


def _share(group: xr.Dataset, scatter: float, nominal: float) -> tuple[float, float, float]:
    """What held of the gaps with this scatter, with its interval."""
    return share_interval(held(group.below.sel(scatter=scatter), nominal), group.place.values)


def at_scatter(values: xr.DataArray, scatter: float | xr.DataArray) -> xr.DataArray:
    """Between what was computed without and with scatter: means and variances go by its square."""
    without, usual = values.isel(scatter=0), values.isel(scatter=-1)
    return without + (usual - without) * (scatter / float(values.scatter[-1])) ** 2


def misfits(cases: xr.Dataset) -> Array:
    """Mean negative log-likelihood of each case (case, GRID): lognormal gaps of this scatter."""
    trial = xr.DataArray(GRID, dims="trial")
    off, variance = at_scatter(cases.off, trial), at_scatter(cases.spread**2, trial)
    variance = np.fmax(
        variance, cases.spread.isel(scatter=0, drop=True) ** 2
    )  # never less than without
    misfit = np.log(variance) / 2 + off**2 / (2 * variance)
    of_cases: Array = misfit.mean(("strength", "pair")).transpose("case", "trial").to_numpy()
    return of_cases


def scatter_of(groups: Sequence[xr.Dataset]) -> tuple[float, float, float]:
    """Most likely scatter of groups of the same weight, and its 95 % interval by drawing places."""
    random, total = np.random.default_rng(0), np.zeros((1 + DRAWS, GRID.size))
    for group in groups:
        place = np.unique(group.place, return_inverse=True)[1]
        places = place.max() + 1
        drawn = random.multinomial(places, np.full(places, 1 / places), DRAWS)
        weights = np.vstack([np.ones(places), drawn])[:, place]
        total += weights @ misfits(group) / weights.sum(axis=1, keepdims=True)
    best = GRID[total.argmin(axis=1)]
    return float(best[0]), *map(float, np.quantile(best[1:], [TAIL, 1 - TAIL]))


# --- what is shown
# ------------------------------------------------------------------------------------


def of(cases: xr.Dataset, part: str, suite: str | None = None) -> xr.Dataset:
    here = cases.part == part
    return cases.isel(case=here if suite is None else here & (cases.suite == suite))


def shown(cases: xr.Dataset) -> dict[str, xr.Dataset]:
    """The groups of the page, by what they are called there."""
    groups = {
        "(a) spectrum, far field": of(cases, SPECTRUM, FAR_FIELD),
        "(a) spectrum, lake bed": of(cases, SPECTRUM, LAKE_BED),
        "(b) own component, far field": of(cases, OWN_COMPONENT, FAR_FIELD),
        "(b) own component, lake bed": of(cases, OWN_COMPONENT, LAKE_BED),
        "(b) other component, far field": of(cases, OTHER, FAR_FIELD),
        "(b) other component, lake bed": of(cases, OTHER, LAKE_BED),
        "(c) same earthquake, other stations": of(cases, "other station"),
        "(c) other earthquake, other stations": of(cases, "other event"),
    }
    return {name: group for name, group in groups.items() if group.sizes["case"]}


def figures_of(all_cases: xr.Dataset, gaps: xr.DataArray) -> xr.Dataset:
    """What the pictures and the tables of the page show, with the ``gaps`` of rules [m]."""
    cases = all_cases.sel(scatter=list(LEVELS))
    groups = shown(cases)
    rows = [
        [[_share(group, s, q) for q in CURVE] for s in cases.scatter.values]
        for group in groups.values()
    ]
    bins = [[list(_binned(group, s)) for s in cases.scatter.values] for group in groups.values()]
    hit = ("group", "scatter", "bin")
    columns = {
        **_with_interval(
            "held", ("group", "scatter", "nominal"), rows, "share of the gaps that held"
        ),
        **_with_interval("hit", hit, bins, "share of the records that hit"),
        "probability": (
            hit,
            np.array(bins)[..., 3],
            _attrs("predicted probability of pounding, mean"),
        ),
    }
    coords = {"group": list(groups), "scatter": cases.scatter, "nominal": CURVE}
    figures = xr.Dataset(columns, coords).assign_attrs(
        title="Predicted gaps and recorded earthquakes", history="benchmarks/reality.py"
    )
    parts = judged_rules(cases, gaps), _scatters(cases), _of_components(all_cases)
    return figures.merge(xr.merge(parts, join="outer", compat="no_conflicts"))


def tables_of(figures: xr.Dataset) -> dict[str, str]:
    """The tables of the page by their names there."""
    made = {"held": _held, "rules": _rules, "components": _components}
    return {name: table(figures) for name, table in made.items()}


def _attrs(long_name: str) -> dict[str, str]:
    return {"units": "1", "long_name": long_name}


def _with_interval(
    name: str, dims: Sequence[str], values: object, long_name: str
) -> dict[str, tuple[Sequence[str], Array, dict[str, str]]]:
    """A share or a scatter with both ends of its interval, which are last in ``values``."""
    names = _with_ends(name, long_name).items()
    return {
        key: (dims, np.array(values)[..., n], _attrs(text)) for n, (key, text) in enumerate(names)
    }


def _binned(group: xr.Dataset, scatter: float) -> Iterator[tuple[float, float, float, float]]:
    """Share that hit with its interval, and mean probability, of each range of probabilities."""
    likely = group.probability.sel(scatter=scatter)
    for low, high in itertools.pairwise(EDGES):
        inside = (
            (likely >= low)
            & ((likely < high) if high < 1 else (likely <= high))
            & group.hit.notnull()
        )
        if not inside.any():
            yield np.nan, np.nan, np.nan, np.nan
            continue
        hit = group.hit.where(inside)
        yield *share_interval(hit.values, group.place.values), float(likely.where(inside).mean())


def _percent(share: tuple[float, ...]) -> str:
    return "{:.0f} ({:.0f} to {:.0f})".format(*(100 * value for value in share))


def _likely(scatter: tuple[float, ...]) -> str:
    return "" if np.isnan(scatter[0]) else "{:.2f} ({:.2f} to {:.2f})".format(*scatter)


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def _held(figures: xr.Dataset) -> str:
    rows = []
    for name in figures.group.values:
        for scatter in figures.scatter.values:
            here = figures.sel(group=name, scatter=scatter)
            cells = [_percent(_ends(here.sel(nominal=q), "held")) for q in NOMINAL]
            rows.append((name if not scatter else "", f"{scatter:g}", *cells))
    return _table(("Gaps from", "scatter", *(f"{100 * q:g} %" for q in NOMINAL)), rows)


# --- scatter
# ------------------------------------------------------------------------------------------


def _scatters(cases: xr.Dataset) -> xr.Dataset:
    """The most likely scatter, of each strength too."""
    parts = *KNOWN_PLACE, *((OWN_COMPONENT, suite) for suite in SUITES)
    groups = {", ".join(group): [of(cases, *group)] for group in parts}
    joint = {
        "other component, both suites": [of(cases, *group) for group in KNOWN_PLACE[2:]],
        "first four rows": [of(cases, *group) for group in KNOWN_PLACE],
    }
    by_strength = [
        [scatter_of([group.sel(strength=[s])])[0] for s in cases.strength.values]
        for (group,) in groups.values()
    ]
    unknown = [[np.nan] * cases.sizes["strength"]] * len(joint)
    likely = [scatter_of(several) for several in (groups | joint).values()]
    columns = _with_interval("likely_scatter", ("source",), likely, "most likely scatter")
    attrs = _attrs("most likely scatter by strength")
    columns["likely_scatter_by_strength"] = ("source", "strength"), [*by_strength, *unknown], attrs
    return xr.Dataset(columns, {"source": list(groups | joint), "strength": cases.strength.values})


# --- rules
# --------------------------------------------------------------------------------------------


def _of_equal_gaps(gaps: xr.DataArray) -> xr.DataArray:
    """Rules that ask for the same gaps everywhere become one, with all their names."""
    names: dict[int, list[str]] = {}
    for rule in range(gaps.sizes["rule"]):
        alike = (
            n for n in names if np.allclose(gaps.isel(rule=n), gaps.isel(rule=rule), rtol=1e-9)
        )
        names.setdefault(next(alike, rule), []).append(str(gaps.rule.values[rule]))
    distinct = gaps.isel(rule=list(names))
    return distinct.assign_coords(rule=[", ".join(alike) for alike in names.values()])


def judged_rules(cases: xr.Dataset, gaps: xr.DataArray) -> xr.Dataset:
    """What records of (a) need over the gap of each rule, over suite and rule.

    A cell is a pair and a strength. The first rule is the simulation; mean gaps are equal to its
    own if the mean logarithms over the cells are.
    """
    gaps = _of_equal_gaps(gaps)
    columns_of_rules: dict[str, list[list[float]]] = {name: [] for name in _RULE_COLUMNS}
    for suite in gaps.suite.values:
        group = of(cases, SPECTRUM, suite).isel(pair=gaps.pair.values)
        needed, place = group.needed.drop_vars("pair", errors="ignore"), group.place.values
        of_suite = gaps.sel(suite=suite).drop_vars("pair")
        equal = np.exp(np.log(of_suite.isel(rule=0) / of_suite).mean(("strength", "pair")))
        for name in gaps.rule.values:
            gap = of_suite.sel(rule=name)
            logs = np.log((needed / gap).where(needed > 0))
            cells = logs.mean("case")
            gaps_tried = gap, gap * equal.sel(rule=name)
            held, held_equal = (
                share_interval((needed <= width).transpose("case", ...).values * 1.0, place)
                for width in gaps_tried
            )
            values = (
                float(np.exp(logs.median())),
                float(np.sqrt(logs.var("case", ddof=1).mean())),
                float(cells.std(ddof=1)),
                float(equal.sel(rule=name)),
                *held,
                *held_equal,
            )
            for column, value in zip(_RULE_COLUMNS, values, strict=True):
                columns_of_rules[column].append(value)
    sizes = gaps.sizes["suite"], gaps.sizes["rule"]
    columns = {
        name: (
            ("suite", "rule"),
            np.reshape(columns_of_rules[name], sizes),
            {"units": "1", "long_name": long_name},
        )
        for name, long_name in _RULE_COLUMNS.items()
    }
    return xr.Dataset(columns, coords={"suite": gaps.suite.values, "rule": gaps.rule.values})


def _with_ends(name: str, long_name: str) -> dict[str, str]:
    return {
        f"{name}{end}": long_name + end.replace("_", ", 95 % interval, ")
        for end in ("", "_lower", "_upper")
    }


_RULE_COLUMNS = {
    "rule_median_ratio": "median of the needed gap over that of the rule",
    "rule_scatter_within": "standard deviation of its logarithm within pairs and strengths",
    "rule_scatter_between": "standard deviation of its logarithm between pairs and strengths",
    "rule_factor": "factor on the gaps of the rule at the mean gap of the simulation",
    **_with_ends("rule_held", "share of the gaps of the rule that held"),
    **_with_ends(
        "rule_held_at_equal_gap", "share of its gaps that held at the mean gap of the simulation"
    ),
}


def _ends(table: xr.Dataset, name: str) -> tuple[float, ...]:
    return tuple(float(table[f"{name}{end}"]) for end in ("", "_lower", "_upper"))


def _rules(figures: xr.Dataset) -> str:
    rows = []
    for suite in figures.suite.values:
        of_suite = figures.sel(suite=suite)
        order = of_suite.rule_held_at_equal_gap.argsort().values[::-1]
        for number, n in enumerate(order):
            rule = of_suite.isel(rule=n)
            rows.append(
                (suite if not number else "", str(rule.rule.values).replace("_", "\\_"),
                 f"{float(rule.rule_median_ratio):.2f}", f"{float(rule.rule_scatter_within):.2f}",
                 f"{float(rule.rule_scatter_between):.2f}", _percent(_ends(rule, "rule_held")),
                 f"{float(rule.rule_factor):.2f}", _percent(_ends(rule, "rule_held_at_equal_gap")))
            )  # fmt: skip
    head = (
        "",
        "rule",
        "median of needed/predicted",
        "scatter within pairs",
        "scatter between pairs",
        "held, %",
        "factor to equal mean gap",
        "held at equal mean gap, %",
    )
    return _table(head, rows)


# --- one component and both
# ---------------------------------------------------------------------------


ONE_COMPONENT = "one component"
REST = "the rest of the suite, scaled by"
_TRIALS = {  # fitted to, tried on, scatters
    OTHER: (ONE_COMPONENT, "the other component", (0.0, USUAL, AFTER)),
    BOTH: (BOTH, "each of them", (0.0, FITTED)),
    PGA_ELSEWHERE: (ONE_COMPONENT, f"{REST} PGA", (0.0, USUAL, AFTER)),
    SA_ELSEWHERE: (ONE_COMPONENT, f"{REST} Sa", (0.0, USUAL, AFTER)),
    SA_ELSEWHERE_BOTH: (BOTH, f"{REST} Sa", (0.0, FITTED)),
}


def _of_components(cases: xr.Dataset) -> xr.Dataset:
    """What held at nominally 90 %, from one component and from both, and most likely scatter."""
    trials = [(part, level) for part, (*_, levels) in _TRIALS.items() for level in levels]
    shares, likely = [], []
    for part, level in trials:
        groups = [of(cases, part, suite) for suite in SUITES]
        shares.append([_share(group, level, CONFIDENCE) for group in groups])
        has_likely = level == 0 and FITTED not in _TRIALS[part][2]
        of_group = (scatter_of([group.sel(scatter=list(LEVELS))]) for group in groups)
        likely.append(list(of_group) if has_likely else [[np.nan] * 3] * len(SUITES))
    dims = ("trial", "suite")
    columns = {
        **_with_interval("trial_held", dims, shares, "share of the gaps of 90 % that held"),
        **_with_interval("trial_scatter", dims, likely, "most likely scatter"),
    }
    coords = {"trial_part": ("trial", [part for part, _ in trials])}
    return xr.Dataset(
        columns, coords | {"trial_level": ("trial", [s for _, s in trials]), "suite": list(SUITES)}
    )


def _components(figures: xr.Dataset) -> str:
    rows = []
    for n in range(figures.sizes["trial"]):
        trial = figures.isel(trial=n)
        fitted, on, levels = _TRIALS[trial.trial_part.item()]
        level = trial.trial_level.item()
        row = [fitted, on] if level == levels[0] else ["", ""]
        row.append("of the fit" if level == FITTED else f"{level:g}")
        of_suites = [trial.sel(suite=suite) for suite in SUITES]
        row += [_percent(_ends(of_suite, "trial_held")) for of_suite in of_suites]
        rows.append([*row, *(_likely(_ends(of_suite, "trial_scatter")) for of_suite in of_suites)])
    held_on = [f"held on the {suite}, %" for suite in SUITES]
    scatters = [f"most likely scatter, {suite}" for suite in SUITES]
    return _table(("Fitted to", "tried on", "scatter", *held_on, *scatters), rows)


def write_page(page: Path, tables: dict[str, str]) -> None:
    """Put each table where the page names it: between ``<!-- name -->`` and ``<!-- end -->``."""
    text = page.read_text(encoding="utf-8")
    for name, table in tables.items():
        pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        text = pattern.sub(lambda match, table=table: f"{match[1]}\n{table}\n\n{match[2]}", text)
    page.write_text(text, encoding="utf-8")
