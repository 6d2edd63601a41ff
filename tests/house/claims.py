"""Numbers in words: the sentences of `claims.toml`, and what computes the values of their fields.

A claim is a sentence of a file, or a part of one, with expressions in braces in place of its
numbers. It stands below the name of its source: a function of this file, which returns the names
that the expressions use; ``code``, the code of the page itself, which `test_docs.py` runs; or
``given``, for what is not computed.
"""

import itertools
import runpy
import string
import tempfile
import tomllib
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import elastic_pairs
import finite_drift
import matplotlib as mpl
import numpy as np
import rules
import two_peaks as two_peaked
import xarray as xr
from commands import answered
from correlation import test_caution
from correlation import test_claims as pairs
from drift_pairs import DERIVED, FILE, MOMENTS, SIMULATION, WITH_MAP, WITH_SIGNATURES, renewed
from reality_tables import tables_of
from scipy.stats import gumbel_r

import stochlin as sl
from stochlin.kernels.correlation.errors import ERROR_OF_OTHERS, ERRORS_OF_NEARLY_EQUAL

ROOT = Path(__file__).parents[2]
GALLERY = FILE.parent
CLAIMS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
LAKE_BED, BROAD = (
    sl.KanaiTajimi(2.0, 0.05, intensity=0.01),
    sl.KanaiTajimi(0.42, 0.6, intensity=0.01),
)
CALCULATED = (  # period and R of both
    *((0.6, 4, 1.0, 4), (1.0, 6, 1.2, 2), (1.2, 5, 1.22, 4.4)),
    *((1.1, 3, 1.9, 5), (1.3, 5, 1.5, 3), (1.7, 4, 2.0, 2)),
)


class Filled(string.Formatter):
    """Its fields are expressions."""

    def get_field(self, field_name: str, args: Any, kwargs: Any) -> tuple[Any, str]:
        value = eval(field_name, dict(kwargs))
        return np.asarray(value).item(), field_name


def plain(text: str) -> str:
    """Without the ends of lines, and of the parts of a string in code."""
    return " ".join(text.split()).replace('" "', "")


def stated(file: str, source: str, names: dict[str, Any]) -> list[str]:
    """The claims of a file by one source, with their numbers."""
    return [
        plain(Filled().vformat(words, (), names)) for words in CLAIMS.get(file, {}).get(source, ())
    ]


def missing(file: str, source: str, names: dict[str, Any]) -> list[str]:
    """Claims that do not stand in the file so."""
    text = plain((ROOT / file).read_text(encoding="utf-8"))
    return [words for words in stated(file, source, names) if words not in text]


def rows(cells: Sequence[Sequence[object]]) -> str:
    """Of a table in Markdown."""
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in cells)


# --- Sources
# ------------------------------------------------------------------------------------------


def given() -> dict[str, Any]:
    return {}


def bias() -> dict[str, Any]:
    """Errors of linearization of the two pictures of the gallery, and on white noise."""
    with mpl.rc_context():
        names = runpy.run_path(str(GALLERY / "plot_03_error_by_strength.py"))
    std, rho = names["errors"].values()
    shown = ("hardening", "strength")
    off_std, off_rho = (
        100 * (abs(each) > 0.1).mean([dim for dim in each.dims if dim not in shown])
        for each in (std, rho)
    )
    factor, hardening, damping = names["R"], names["alpha"], names["xi"]
    on_noise = sl.Bilinear(1.0, damping, hardening, reduction_factor=factor)
    axes = [xr.DataArray(2 * np.geomspace(0.1, 4, 60), dims=name) for name in ("first", "second")]
    pair = [sl.Bilinear(axis, 0.05, 0.05, reduction_factor=4) for axis in axes]
    return {
        "std": std,
        "rho": rho,
        "off_std": off_std.sel(hardening=slice(0, 0.1)),
        "off_rho": off_rho,
        "known": 100 * sl.correlate(*pair, LAKE_BED).bias.notnull().mean(),
        "too_small": -100 * sl.linearize(on_noise, sl.WhiteNoise()).bias,
    }


def stationary() -> dict[str, Any]:
    """Linearized over simulated values, (period, R, ratio), of 144 pairs on each of two grounds."""
    results: dict[str, Any] = {}
    for band, damping in (("broad", pairs.BROAD), ("narrow", pairs.NARROW)):
        cases = itertools.product(pairs.PERIODS, pairs.FACTORS)
        columns = zip(*(_over_simulated(damping, *case) for case in cases), strict=True)
        sizes = len(pairs.PERIODS), len(pairs.FACTORS), -1
        for name, column in zip(("std", "gap"), columns, strict=True):
            results[f"{band}_{name}"] = np.reshape(column, sizes)
    strength = xr.DataArray([2.0, 4.0, 6.0], dims="R")
    stiff = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=strength) for T in (0.25, 0.5)]
    linear, exact = (
        sl.correlate(
            *stiff, LAKE_BED, method, closure="gaussian", paths=2048
        ).relative_displacement_std
        for method in ("linearization", "simulation")
    )
    return {**results, "stiff_gap": linear / exact}


def _over_simulated(damping: float, period: float, factor: float) -> tuple[Any, Any]:
    """Of the standard deviations of all structures, and of the gaps of all pairs."""
    exact = pairs.simulated(damping, period, factor)
    linear, _ = pairs.formulas(damping, period, factor)
    std = np.append(linear.displacement_std_1, linear.displacement_std_2.max())
    gap = linear.relative_displacement_std.values / exact.difference_std(exact.rho)
    return std / exact.std, gap


def drift_times() -> dict[str, Any]:
    """Of structures with a period of 1 s, by R."""
    strength = xr.DataArray([1.0, 2.0, 6.0], [("R", [1, 2, 6])])
    structure = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=strength)
    grounds = {"broad": BROAD, "lake_bed": LAKE_BED}
    return {
        name: sl.linearize(structure, ground, "drift").drift_time
        for name, ground in grounds.items()
    }


def motions() -> dict[str, Any]:
    """Every rule in motions of 30 s: errors [%] over hardening, ratio and period."""
    results = rules.results()
    by_ground: dict[str, list[xr.DataArray]] = {}
    for heading, (error, _) in results.items():
        by_ground.setdefault(heading.partition(",")[0], []).append(100 * error)
    strength = xr.DataArray(list(rules.FACTORS), dims="R", name="R")
    return {
        "table": rules.table(results),
        "standard_error": 100 * max(float(error.max()) for _, error in results.values()),
        "broad": xr.concat(by_ground["broad band"], strength),
        "lake": xr.concat(by_ground["lake bed"], strength),
        "cases": ["hardening", "ratio", "period"],
    }


def sides() -> dict[str, Any]:
    """The gap for 90 % to one side over that to either side, of elastic pairs and at R = 6."""

    def ratios(**strength: float) -> Any:
        found: list[Any] = []
        for ground, periods in rules.GROUNDS.values():
            for period in periods:
                ratio_of = (*rules.RATIOS.values, 1.0)
                row = [sl.Bilinear(ratio * period, 0.05, **strength) for ratio in ratio_of]
                motion = {"duration": rules.DURATION, "envelope": rules.QUAKE, "paths": 4096}
                apart = sl.simulate(row, ground, scatter=0.0, **motion).separation.values
                ahead, behind = apart[:, :-1, -1], apart[:, -1, :-1]
                one, either = (
                    np.quantile(gaps, rules.CONFIDENCE, axis=0)
                    for gaps in (ahead, np.maximum(ahead, behind))
                )
                found.extend(one / either)
        return np.array(found)

    return {"elastic": ratios(), "yielding": ratios(hardening=0.05, reduction_factor=6)}


def crossings() -> dict[str, Any]:
    """Formulas against simulation for elastic pairs: the confidence [-], and the gap [%]."""
    errors = elastic_pairs.errors()
    ends = [0, 2.5, 97.5, 100]
    return {
        "confidence": np.percentile(errors.confidence, ends),
        "gap": np.percentile(100 * errors.gap, ends),
        "pairs": errors.sizes["pair"],
    }


def methods() -> dict[str, Any]:
    """Errors [%] of a gap by every method: what the picture of the gallery shows."""
    errors = runpy.run_path(str(GALLERY / "plot_12_error_by_way.py"))["errors"]
    return {"errors": errors, "percentile": np.percentile}


def closures() -> dict[str, Any]:
    """Every closure against the gallery's simulated pairs, and its errors where regions differ."""
    table = xr.load_dataset(FILE, engine="scipy")
    xr.testing.assert_allclose(table, renewed(table), rtol=1e-6)
    table = xr.concat([table, *_parts(table)], "closure", data_vars="minimal")
    white, soil = table.white.values.astype(bool), ~table.white.values.astype(bool)
    shown = {
        "Gaussian": ("gaussian", white | soil),
        "clipped": ("clipped", white | soil),
        "drift as derived, (1) to (8)": (DERIVED, white | soil),
        "the same with the map of $\\sigma$": (WITH_MAP, white | soil),
        "the same with signatures, (11)": (WITH_SIGNATURES, white | soil),
        "**drift**": ("drift", white | soil),
        "drift, Kanai-Tajimi": ("drift", soil),
        "drift, white noise": ("drift", white),
    }
    lines = []
    for name, (closure, here) in shown.items():
        std, rho, apart = _errors(table.isel(case=here), closure)
        cells = [f"{value:.3f}" for value in (std.mean(), np.percentile(std, 95), rho.mean())]
        cells += [f"{abs(apart).mean():.3f}", f"{apart.min():.2f}", (apart < -0.2).sum()]
        lines.append([name, here.sum(), *cells])
    stiff = np.minimum(table.period_1, table.period_2) < 0.5
    narrow = table.isel(case=soil & stiff & (table.ground_damping < 0.1))
    results = {"narrow": _errors(narrow, "drift"), "derived": 100 * _errors(table, DERIVED)[0]}
    std, rho, apart = _errors(table, "drift")
    usual = {"std": 100 * std, "rho": rho, "apart": 100 * abs(apart), "percentile": np.percentile}
    return {**results, **usual, "table": rows(lines), "white": white.sum()}


def two_peaks() -> dict[str, Any]:
    """The same parts of the drift closure on ground with two peaks, a line each."""
    pairs = xr.load_dataset(two_peaked.PAIRS, engine="scipy")
    lines = []
    for std, rho, apart in two_peaked.errors(pairs).values():
        cells = [f"{value:.3f}" for value in (std.mean(), np.percentile(std, 95), rho.mean())]
        cells += [f"{abs(apart).mean():.3f}", f"{apart.min():.2f}", (apart < -0.2).sum()]
        lines.append(rows([cells]))
    uncertain = 100 * pairs[two_peaked.STANDARD_ERROR].max()
    return {"lines": lines, "size": pairs.sizes["case"], "uncertain": uncertain}


def finite() -> dict[str, Any]:
    """Gaps of motions of finite length without simulation, against simulated ones: errors in %."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sl.ImplausibleInput)  # envelopes of short motions
        pairs = xr.load_dataset(finite_drift.PAIRS, engine="scipy")
        table = finite_drift.errors(pairs)
        without = finite_drift.ablation(pairs)
        of_confidence = finite_drift.errors_of_confidence(pairs)
    kinds = {family: pairs.family == family for family in finite_drift.FAMILIES}
    kinds |= {"`caution` 0": table.caution == 0, "`caution` 1": table.caution == 1}
    lines = [
        [kind, int(here.sum()), *map(finite_drift.in_words, table.error[here.values].values.T)]
        for kind, here in kinds.items()
    ]
    narrow = pairs.ground.isin(list(finite_drift.NARROW)).values
    parts = [
        [part, finite_drift.in_words(error[~narrow]), finite_drift.in_words(error[narrow])]
        for part, error in without.items()
    ]
    error = 100 * table.error[:, finite_drift.MIDDLE]
    usual, unsafe = error[table.caution == 0], table.caution[error < -15]
    return {
        "table": rows(lines),
        "parts": rows(parts),
        "size": pairs.sizes["case"],
        "mean": float(usual.mean()),
        "usual": usual.size,
        "most": float(np.percentile(abs(usual), 95)),
        "worst": float(usual.min()),
        "flagged": int((table.caution == 1).sum()),
        "off_flagged": int((abs(error[table.caution == 1]) > 15).sum()),
        "off_usual": int((abs(usual) > 15).sum()),
        "worst_of_all": float(error.min()),
        "off": [
            np.percentile(of_confidence[table.caution.values == flag], [0, 2.5, 97.5, 100])
            for flag in (0, 1)
        ],
        "recall": f"{int((unsafe == 1).sum())} of {unsafe.size}",
    }


def _parts(table: xr.Dataset) -> Iterator[xr.Dataset]:
    """The drift closure with some of its corrections, along ``closure``."""
    by_closure = table[list(MOMENTS)]
    derived = by_closure.rho.sel(closure=[DERIVED])
    corrected = by_closure.sel(closure=["drift"]).assign_coords(closure=[WITH_MAP])
    yield corrected.assign(rho=derived.assign_coords(closure=[WITH_MAP]))
    with patch("stochlin.kernels.correlation.pairs.by_nearness", lambda rho, *_: (rho, 0 * rho)):
        without = renewed(table)[list(MOMENTS)]
    yield without.sel(closure=["drift"]).assign_coords(closure=[WITH_SIGNATURES])


def _errors(table: xr.Dataset, closure: str) -> tuple[Any, ...]:
    """Of sigma (relative, both structures), of rho, and of the deviation of u_1 - u_2, signed."""
    exact, results = table.sel(closure=SIMULATION), table.sel(closure=closure)
    std = [
        abs(results[name] / exact[name] - 1)
        for name in ("displacement_std_1", "displacement_std_2")
    ]
    apart = [
        test_caution.difference(each.displacement_std_1, each.displacement_std_2, each.rho)
        for each in (results, exact)
    ]
    return (
        np.concatenate(std),
        abs(results.rho - exact.rho).values,
        (apart[0] / apart[1] - 1).values,
    )


def expected() -> dict[str, Any]:
    """What the drift closure states of its errors."""
    kinds = {"white noise": sl.WhiteNoise, "Kanai-Tajimi": sl.KanaiTajimi}
    kinds["Clough-Penzien"] = sl.CloughPenzien
    table = rows([[name, *kind.calibration.rho_errors] for name, kind in kinds.items()])
    return {"of_rho": table, "nearly_equal": ERRORS_OF_NEARLY_EQUAL, "others": ERROR_OF_OTHERS}


def cautions() -> dict[str, Any]:
    """Whether the caution of the difference protects pairs of five kinds that were simulated."""
    kinds = {
        "domain": "whole domain",
        "stiff": "stiff, $T/T_g$ 0.2 to 0.5, $\\xi_g$ 0.03 to 0.1",
        "ridge": "$T$ within 14 % of $\\sqrt\\alpha\\,T_g$",
        "equal": "nearly equal",
        "cp": "Clough-Penzien ground",
    }
    lines = []
    for kind, name in kinds.items():
        caution, off = _compared(kind)
        trusted = off[caution == 0]
        cells = [f"{abs(off).mean():.3f}", f"{np.percentile(abs(off), 95):.3f}"]
        cells += [f"{share(off < -limit):.1f} %" for limit in (0.1, 0.2)] + [
            f"{share(caution == 0):.0f} %"
        ]
        cells += [f"{share(trusted < -limit):.1f} %" for limit in (0.1, 0.2)] + [
            f"{trusted.min():.2f}"
        ]
        lines.append([name, off.size, *cells])
    return {"table": rows(lines)}


def _compared(kind: str) -> tuple[Any, Any]:
    """Caution and relative error of all pairs of a kind with periods within a factor of 3."""
    with (ROOT / "tests" / "correlation" / "drift_pairs.nc").open("rb") as stream:
        sample = xr.load_dataset(stream, engine="scipy").astype(float).sel(kind=kind)
    columns = [sample.structures.sel(column=name, drop=True) for name in sample.column.values]
    damping, *high_pass = (
        sample.ground.sel(property=name, drop=True) for name in sample.property.values
    )
    ground = sl.KanaiTajimi(1.0, damping)
    if kind == "cp":
        ground = sl.CloughPenzien(1.0, damping, *high_pass)
    sides = [columns, [column.rename(structure="structure_2") for column in columns]]
    first, second = (
        sl.Bilinear(period, damping, hardening, reduction_factor=3 * strength)
        for period, damping, hardening, strength in sides
    )
    results = sl.correlate(first, second, ground, closure="drift")
    exact = sample.displacement_std, sample.displacement_std.rename(structure="structure_2")
    off = results.relative_displacement_std / test_caution.difference(*exact, sample.rho) - 1
    near = np.abs(np.log(sides[0][0] / sides[1][0])) <= np.log(3)
    chosen = (near & (sample.structure < sample.structure_2)).transpose(*off.dims).values
    return results.relative_displacement_caution.values[chosen], off.values[chosen]


def hard_cautions() -> dict[str, Any]:
    """The same of seven families of pairs that are hard for the closure, the eighth being easy."""
    stored, cautions, ratios = test_caution.hard_pairs(), [], []
    for family, number in itertools.product(range(7), range(stored.sizes["number"])):
        stored_pair = stored.isel(family=family, number=number)
        pair = test_caution.models(stored_pair.ground.values, stored_pair.structures.values)
        table = sl.correlate(*pair, closure="drift")
        exact = stored_pair.simulated.sel(quantity="relative_displacement_std")
        cautions.append(table.relative_displacement_caution.item())
        ratios.append(float(table.relative_displacement_std / exact))
    trusted = np.array(cautions) == 0
    return {
        "size": trusted.size,
        "trusted": share(trusted),
        "off": 100 * (np.array(ratios)[trusted] - 1),
    }


def share(condition: Any) -> float:
    """In per cent."""
    return 100 * float(np.mean(condition))


def example() -> dict[str, Any]:
    """The command `stochlin gap` for its example."""
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "case.toml"
        case.write_text(answered("gap", "--example").output, encoding="utf-8")
        printed = answered("gap", case).stdout
    return {"printed": printed.split("\n\n")[0]}


def calculator() -> dict[str, Any]:
    """Shares of motions that the gaps of the calculator prevent, for six pairs on two grounds."""
    code = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
    page = {"sl": sl, "gumbel_r": gumbel_r}
    exec(code[code.index("def gaps") : code.index("random =")], page)
    motion = {
        "duration": 30,
        "envelope": sl.AminAng(rise_end=4, strong_end=15, decay=0.35),
        "seed": 7,
    }
    shares, sizes = [], []
    for ground, pair in itertools.product((BROAD, LAKE_BED), CALCULATED):
        sides = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=R) for T, R in (pair[:2], pair[2:]))
        simulated = sl.separation(*sides, ground, **motion)
        gap = page["gaps"](*pair, ground)
        shares.append(float((simulated.separation_samples <= gap).mean()) if gap > 0 else np.nan)
        sizes.append(float(gap / simulated.gap.sel(rule="simulation")) - 1)
    assert np.flatnonzero(np.isnan(shares)).tolist() == [6]  # stiff on the lake bed
    return {"shares": shares, "sizes": sizes, "least": np.nanmin, "most": np.nanmax}


def reality() -> dict[str, Any]:
    """Predicted gaps and recorded earthquakes: what the tables of the page show."""
    table = xr.load_dataset(GALLERY / "reality.nc", engine="scipy")

    def sufficient(group: str, nominal: float = 0.9) -> str:
        return _with_interval("held", table.sel(group=group, nominal=nominal, scatter=0.0))

    def trial(part: str, suite: str, level: float) -> xr.Dataset:
        here = (table.trial_part == part) & (table.trial_level == level)
        return table.isel(trial=here.values.argmax()).sel(suite=suite)

    def of_rule(name: str, suite: str = "far field") -> xr.Dataset:
        return table.sel(rule=name, suite=suite)

    return {
        **tables_of(table),
        "d": table,
        "sufficient": sufficient,
        "tried": lambda *names: _with_interval("trial_held", trial(*names)),
        "likely": lambda *names: trial(*names, 0.0).trial_scatter,
        "scatter_of": lambda name: table.likely_scatter.sel(source=name),
        "within": table.rule_scatter_within.mean("rule"),
        "of_rule": of_rule,
        "fails": lambda *names: 100 * (1 - of_rule(*names).rule_held_at_equal_gap),
    }


def _with_interval(name: str, here: xr.Dataset) -> str:
    ends = (100 * here[f"{name}{end}"].item() for end in ("", "_lower", "_upper"))
    return "{:.0f} ({:.0f} to {:.0f})".format(*ends)
