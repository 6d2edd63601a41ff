"""The explorer's charts, from datasets to figures of plotly.js, readable in grey."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.models.rules.codes import FIXED, HEIGHT
from stochlin.views.probability.pictures import ESTIMATES, known
from stochlin.views.shared.style import CURVES
from stochlin.views.shared.symbols import typeset_html
from stochlin.views.shared.words import BEYOND, FAR, per_cent, rule_label

Figure = dict[str, Any]
DASHES = ("solid", "dash", "dashdot", "dot", "longdash", "longdashdot")  # as in CURVES
GREY, FAINT = "#555", "#ddd"
NORMAL = 1.96  # standard errors to either side of a 95 % interval
KINDS = {  # of rules: marker and name
    "simulation": ("star", "simulation, 95 %"),
    "equation_3": ("circle", "eq. (3)"),
    "linearization": ("diamond", "linearization"),
    "code": ("square", "building codes"),
}
# Kinds whose rules share a line until each is to have its own, and those that have it from the first.
TOGETHER = {"equation_3": "eq. (3), ρ by eq. (4)", "code": "building codes"}
ALONE = ("eq_3_simulated", "eq_3_drift", "eq_3_linearized", "eq_3_white_noise")
LINEARIZED = ", linearized peaks"
BY_HEIGHT = ("simulation", "linearization")  # the first that there is
CHANCE = "confidence_of_no_pounding"
HEIGHT_CHART, LINE = 170, 34  # px, of the gap over the height, and of a rule
AROUND, BELOW = 170, 55  # px: around the axes, with the legend; from the axes to the legend
RATIO_TICKS = (0.25, 0.5, 1, 2, 4)
FEW = 6  # ticks of an axis
UNSAFE = 2  # of the flag ``verdict``
BANDS = ("#dcdcdc", "#a9a9a9")  # of simulations: that of few motions, that of all
RHO = (
    ("rho_drift", 0, "linearization, drift closure"),
    ("rho_linearized", 1, "linearization, Gaussian closure"),
    ("rho_white_noise", 3, "eq. (4), white noise"),
)


class RuleGap(NamedTuple):
    """A rule in the chart of the gaps; NaN for what is not known of it."""

    label: str  # of its line
    rule: str  # as in the table
    kind: str
    gap: float  # [cm]
    error: float
    verdict: float
    lower: float  # [cm]
    upper: float


def label_without_simulation(rule: str, family: str) -> str:
    """Name of a rule that is fed with linearized peaks: the bare name is of the simulated ones."""
    without_peaks = rule == "linearization" or family in (HEIGHT, FIXED)
    return rule_label(rule) + ("" if without_peaks else LINEARIZED)


def spectra_figure(table: xr.Dataset, periods: tuple[float, float]) -> Figure:
    """PSD of the ground above, of the displacements below, over period; both periods marked."""
    period = table.period.values
    curves = [_curve(period, 1e4 * table.psd_ground.values, 0, "ground")]
    for number in (1, 2):
        values = 1e4 * table[f"displacement_psd_{number}"].values
        name = f"displacement, building {number}"
        curves.append(_curve(period, values, number, name) | {"yaxis": "y2"})
    layout = _layout("period T [s]", "PSD [cm²/s³]")
    ticks = _log_ticks(period)
    layout["xaxis"] |= {"type": "log", "range": _log_range(period), "anchor": "y2", "tickvals": ticks}
    layout["yaxis"] |= {"domain": [0.56, 1], "rangemode": "tozero"}
    layout["yaxis2"] = layout["yaxis"] | {
        "domain": [0, 0.46],
        "title": {"text": "PSD [cm² s]", "standoff": 6},
    }
    layout["shapes"] = [_vertical(period, DASHES[n]) for n, period in enumerate(periods, start=1)]
    first_right = periods[0] > periods[1]  # the words go to the outer sides of the lines
    layout["annotations"] = [
        _note(float(np.log10(period)), typeset_html(f"T{n}"))
        | {"xanchor": "left" if (n == 1) == first_right else "right"}
        for n, period in enumerate(periods, start=1)
    ]
    return _figure(curves, layout)


def correlation_figure(table: xr.Dataset, simulated: xr.Dataset | None = None) -> Figure:
    """Rho over the ratio of periods; simulation, if there is one, as points with 95 % intervals."""
    ratio = table.period_ratio.values
    shown = [curve for curve in RHO if curve[0] in table]
    curves = [_curve(ratio, table[name].values, style, text) for name, style, text in shown]
    if simulated is not None:
        error = NORMAL * simulated.rho_standard_error.values
        curves.append(
            {
                "x": _plain(simulated.period_ratio.values),
                "y": _plain(simulated.rho.values),
                "error_y": {"type": "data", "array": _plain(error), "thickness": 1.2, "width": 3},
                "mode": "markers",
                "marker": {"color": "#000", "size": 7, "symbol": "circle-open", "line": {"width": 1.6}},
                "name": "simulation, 95 %",
            }
        )
    values = [table[name] for name, _, _ in shown] + ([] if simulated is None else [simulated.rho])
    low = min(float(v.min()) for v in values)
    layout = _layout(typeset_html("ratio of periods T2/T1"), typeset_html("correlation coefficient ρ"))
    layout["xaxis"] |= {"type": "log", "range": _log_range(ratio), "tickvals": list(RATIO_TICKS)}
    layout["yaxis"] |= {"range": [min(-0.05, np.floor(low * 10) / 10), 1.03]}
    own = float(table.attrs["period_ratio"])
    layout["shapes"] = [_vertical(own, "solid")]
    layout["annotations"] = [_note(float(np.log10(own)), typeset_html(f"T2/T1 = {own:.3g}"))]
    return _figure(curves, layout)


def gaps_figure(
    table: xr.Dataset,
    recorded: xr.Dataset | None = None,
    simulated: xr.Dataset | None = None,
    every: bool = True,
) -> Figure:
    """The gap by every rule that has one, and the existing gap; with errors where it is simulated.

    Rules with simulated peaks, if there are some, stand above those with linearized ones, and have the
    bare names. Beside them, if there are some, the gaps that the records need. If not ``every`` rule
    has a line of its own, rules of a kind share one, and those with linearized peaks are left out once
    there are simulated ones.

    For buildings with storeys, below it the gap over the height, by simulation and by linearization.
    """
    rows = _lines(table, simulated, every)
    names, gaps = list(dict.fromkeys(row.label for row in rows)), np.array([row.gap for row in rows])
    near = [row for row in rows if row.gap <= FAR * np.median(gaps)]
    curves = [
        _points([row for row in near if row.kind == kind], symbol) | {"name": text}
        for kind, (symbol, text) in KINDS.items()
        if any(row.kind == kind for row in rows)
    ]
    of_records = [] if recorded is None else 100 * recorded.separation.values
    if recorded is not None:
        names.append("records")
        curves.append(_of_records(recorded, of_records))
    existing = 100 * table.attrs["gap_m"]
    layout = _layout("gap [cm]", "")
    highest = float(np.nanmax([*(row.gap for row in near), *of_records, existing]))
    layout["xaxis"] |= {"range": [0, (1.6 if len(near) < len(rows) else 1.22) * highest]}
    far = {row.label: row.gap for row in rows if row not in near}
    beyond = [
        _note(1, f"{gap:.0f} cm {BEYOND}")
        | {"xref": "paper", "y": label, "yref": "y", "xanchor": "right", "yanchor": "middle"}
        for label, gap in far.items()
    ]
    layout["yaxis"] |= {"type": "category", "categoryarray": names, "nticks": 0}
    layout["yaxis"] |= {"range": [-0.6, len(names) - 0.1], "tickfont": {"size": 11}}
    two_lines = [name.replace(LINEARIZED, f",<br>{LINEARIZED[2:]}") for name in names]
    layout["yaxis"] |= {"tickvals": names, "ticktext": two_lines}
    _set_height(layout, LINE * len(names))
    layout["shapes"] = [_vertical(existing, "dash")]
    layout["annotations"] = [_note(existing, "existing gap"), *beyond]
    over_height = [data for data in (table, simulated) if data is not None and told_by_height(data)]
    if over_height:
        curves += [_over_height(data, style) for style, data in enumerate(over_height, start=1)]
        _add_heights(layout, float(table.height[-1]))
    return _figure(curves, layout)


def _set_height(layout: Figure, axes: float) -> None:
    """The height of a chart with axes of this height [px], and its legend below them."""
    layout["height"] = axes + AROUND
    layout["legend"] |= {"y": -BELOW / axes}


def _add_heights(layout: Figure, top: float) -> None:
    """Room for the gap over the height, up to this one, below the rules."""
    above = layout["height"] - AROUND
    share = HEIGHT_CHART / (above + HEIGHT_CHART)
    _set_height(layout, above + HEIGHT_CHART)
    layout["yaxis"] |= {"domain": [share, 1]}
    title = {"text": "height [m]", "standoff": 6}
    layout["yaxis2"] = layout["xaxis"] | {"title": title, "range": [0, 1.05 * top], "anchor": "x"}
    layout["yaxis2"] |= {"domain": [0, 0.8 * share], "automargin": True}
    layout["xaxis"] |= {"anchor": "y2"}


def _lines(table: xr.Dataset, simulated: xr.Dataset | None, every: bool) -> list[RuleGap]:
    """The rules from below; each on a line of its own, or some of a kind on one."""
    rows = _rows(table, [*map(label_without_simulation, table.rule.values, table.family.values)])
    above = []
    if simulated is not None:
        above = _rows(simulated, [rule_label(str(rule)) for rule in simulated.rule.values])
    if every:
        return (above + [row for row in rows if row.label not in {gap.label for gap in above}])[::-1]
    peaks = "" if above else LINEARIZED
    return [
        row._replace(label=TOGETHER[row.kind] + peaks)
        if row.kind in TOGETHER and row.rule not in ALONE
        else row
        for row in reversed(above or rows)
    ]


def _rows(table: xr.Dataset, labels: list[str]) -> list[RuleGap]:
    """The rules that have a gap, in the order of the table, under these names."""
    unknown = np.full(table.sizes["rule"], np.nan)
    gap, lower, upper = (
        100 * table[name].values if name in table else unknown
        for name in ("gap", "gap_lower", "gap_upper")
    )
    error, verdict = (table[name].values if name in table else unknown for name in ("error", "verdict"))
    fields = zip(
        labels, table.rule.values, table.kind.values, gap, error, verdict, lower, upper, strict=True
    )
    return [row for row in map(RuleGap._make, fields) if np.isfinite(row.gap)]


def _of_records(recorded: xr.Dataset, gaps: Any) -> Figure:
    """The gap of each, all on one line."""
    look = {"color": GREY, "size": 9, "symbol": "line-ns-open", "line": {"width": 1.6}}
    return {
        "x": _plain(gaps),
        "y": ["records"] * len(gaps),
        "text": [str(name) for name in recorded.record.values],
        "mode": "markers",
        "marker": look,
        "name": "records",
        "hovertemplate": "%{text}: %{x:.1f} cm<extra></extra>",
    }


def told_by_height(table: xr.Dataset) -> str:
    """The rule whose gap is shown over the height; none where there is one height, or no gap."""
    if "gap_at_height" not in table or table.sizes["height"] < 2:
        return ""
    known = table.rule.values[table.gap.notnull().values]
    return next((name for name in BY_HEIGHT if name in known), "")


def _over_height(table: xr.Dataset, style: int) -> Figure:
    """The gap that is sufficient at each height, by one rule."""
    row = table.sel(rule=told_by_height(table))
    name = f"{rule_label(str(row.rule.values))}, by height"
    curve = _curve(100 * row.gap_at_height.values, row.height.values, style, name)
    return curve | {"yaxis": "y2", "hovertemplate": "%{y:.1f} m: %{x:.1f} cm<extra></extra>"}


def simulations(table: xr.Dataset, simulated: xr.Dataset | None) -> list[xr.Dataset]:
    """Those of the probability: that of few motions, which follows the sliders, and that of all."""
    both = [data for data in (table, simulated) if data is not None and f"{CHANCE}_simulated" in data]
    return both[:1] if len({data.attrs["paths"] for data in both}) == 1 else both


def probability_figure(table: xr.Dataset, simulated: xr.Dataset | None = None) -> Figure:
    """Probability of no pounding up to each time; simulations as bands."""
    stem, time = CHANCE, table.time.values
    curves = []
    for colour, data in zip(BANDS, simulations(table, simulated), strict=False):
        low, high = (data[f"{stem}_simulated_{end}"].values for end in ("lower", "upper"))
        edge: Figure = {"mode": "lines", "line": {"width": 0}, "hoverinfo": "skip"}
        curves.append(edge | {"x": _plain(time), "y": _plain(low), "showlegend": False})
        name = f"simulation of {data.attrs['paths']} motions, 95 %"
        band: Figure = {"fill": "tonexty", "fillcolor": colour, "name": name}
        curves.append(edge | band | {"x": _plain(data.time.values), "y": _plain(high)})
    for number, (ending, text) in enumerate(ESTIMATES):
        if known(table, stem + ending):
            curves.append(_curve(time, table[stem + ending].values, (0, 3, 1, 2)[number], text))
    layout = _layout("time [s]", "probability of no pounding")
    layout["xaxis"] |= {"range": [0, float(time[-1])]}
    layout["yaxis"] |= {"range": [-0.02, 1.03]}
    wanted = float(table.attrs["confidence"])
    line = {"color": GREY, "width": 1, "dash": "dash"}
    layout["shapes"] = [
        {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": wanted, "y1": wanted, "line": line}
    ]
    layout["annotations"] = [
        _note(1, "wanted") | {"xref": "paper", "y": wanted, "yref": "y", "xanchor": "right"}
    ]
    return _figure(curves, layout)


def _points(rows: list[RuleGap], symbol: str) -> Figure:
    """Rules of one kind; open markers are unsafe, a number beside those alone on a line is the error."""
    lines = [row.label for row in rows]
    alone = [lines.count(line) == 1 for line in lines]
    points: Figure = {
        "x": _plain([row.gap for row in rows]),
        "y": lines,
        "mode": "markers+text",
        "text": [
            per_cent(row.error, sign="+") if own and np.isfinite(row.error) and row.error else ""
            for row, own in zip(rows, alone, strict=True)
        ],
        "hovertext": [
            row.label if own else rule_label(row.rule) for row, own in zip(rows, alone, strict=True)
        ],
        "textposition": "middle right",
        "cliponaxis": False,
        "marker": {
            "symbol": [f"{symbol}-open" if row.verdict == UNSAFE else symbol for row in rows],
            "size": 10,
            "color": CURVES[0][0],
            "line": {"width": 1.6},
        },
        "hovertemplate": "%{hovertext}: %{x:.1f} cm<extra></extra>",
    }
    if any(np.isfinite(row.lower) for row in rows):
        points["error_x"] = {
            "type": "data",
            "symmetric": False,
            "array": _plain([row.upper - row.gap for row in rows]),
            "arrayminus": _plain([row.gap - row.lower for row in rows]),
            "thickness": 1.5,
        }
    return points


def _curve(x: Any, y: Any, style: int, name: str) -> Figure:
    line = {"color": CURVES[style][0], "dash": DASHES[style], "width": 2}
    return {"x": _plain(x), "y": _plain(y), "mode": "lines", "line": line, "name": name}


def _plain(values: Any) -> list[Any]:
    """Numbers for JSON, which knows no NaN."""
    return [float(value) if np.isfinite(value) else None for value in np.asarray(values)]


def _log_range(values: Any) -> list[float]:
    low, high = np.log10([np.min(values), np.max(values)])
    return [float(low - 0.01), float(high + 0.01)]


def _log_ticks(values: Any) -> list[float]:
    """Few round numbers within these: 1, 2 and 5 in every decade, or 1 alone where that is too many."""
    low, high = np.min(values), np.max(values)
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    for steps in ((1, 2, 5), (1, 3), (1,)):
        ticks = [float(f"{step}e{power}") for power in decades for step in steps]
        ticks = [tick for tick in ticks if low <= tick <= high]
        if len(ticks) <= FEW:
            break
    return ticks


def _vertical(x: float, dash: str) -> Figure:
    line = {"color": GREY, "width": 1.2, "dash": dash}
    return {"type": "line", "yref": "paper", "x0": x, "x1": x, "y0": 0, "y1": 1, "line": line}


def _note(x: float, text: str) -> Figure:
    """Words above the plot, at a place of the axis (its logarithm on a logarithmic one)."""
    return {
        "x": x,
        "y": 1,
        "yref": "paper",
        "yanchor": "bottom",
        "text": text,
        "showarrow": False,
        "font": {"size": 11, "color": "#222"},
    }


def _layout(x: str, y: str) -> Figure:
    axis = {
        "fixedrange": True,
        "gridcolor": FAINT,
        "linecolor": GREY,
        "ticks": "outside",
        "zeroline": False,
        "nticks": FEW,
        "exponentformat": "power",
    }
    return {
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": "#222"},
        "margin": {"l": 62, "r": 16, "t": 26, "b": 46},
        "paper_bgcolor": "#fff",
        "plot_bgcolor": "#fff",
        "hovermode": "closest",
        "legend": {"orientation": "h", "x": 0, "y": -0.2, "yanchor": "top"},
        "xaxis": axis | {"title": {"text": x, "standoff": 8}},
        "yaxis": axis | {"title": {"text": y, "standoff": 6}, "automargin": True},
        "autosize": True,
    }


def _figure(curves: list[Figure], layout: Figure) -> Figure:
    drawn = [{"type": "scatter"} | curve for curve in curves]
    return {"data": drawn, "layout": layout, "config": {"displayModeBar": False, "responsive": True}}
