"""Separation of two buildings by the rules of building codes, in one table."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.separation.critical_gap import equation_3
from stochlin.applications.separation.storeys import spectral_peaks
from stochlin.applications.sites.elastic_spectra import (
    DividedBy,
    as_elastic,
    doubt_of_pga,
    taken_in_words,
)
from stochlin.applications.sites.spectra import checked_spectrum
from stochlin.messages import DoubtfulInput, brief, refuse
from stochlin.models.arguments import Truth, checked, is_number
from stochlin.models.parameters import Model, Parameter
from stochlin.models.rules import look_up
from stochlin.models.rules.codes import (
    BOTH,
    CODE_RULES,
    CodeRule,
    Site,
    Zone,
    code_rule,
    code_rule_names,
)
from stochlin.models.structures import AnyStructure
from stochlin.solver.tables import labels

PEAK_NAMES = "peak_1", "peak_2"
# What the displacements are, with or without the factors of a code.
DEFINED_BY_CODE = "displacements as each code defines them, its factors included"
DESIGN_FORCES = "displacements under design forces, which each code multiplies by its factors"
ELASTIC_PEAKS = (
    ", of the elastic spectrum by the CQC over the modes of each building, cqc over those of both"
)
NEEDS = "needs "  # beginning of a text about missing arguments
CODE_TEXTS: Mapping[str, str] = {
    "family": "what governs a building code: SRSS or sum of the peaks, the height, or a fixed "
    "distance",
    "reference": "source of the rule",
    "mark": "how the rule was checked: S seen in a copy of its source, C derived and checked, "
    "P in the text of the paper, M not compared with its source; high or low says how sure it is",
    "assumptions": "assumptions of the rule",
    "missing": "what the rule needs and was not given",
}


@dataclass(frozen=True)
class Rule:
    """A row of a table of rules: the gap of a rule in each cell, or at each height of a meeting."""

    name: str
    kind: str
    gaps: Any = np.nan  # [m], NaN if not available
    rhos: Any = None
    family: str = ""  # for a building code only
    reference: str = ""
    mark: str = ""
    assumptions: str = ""
    missing: str = ""
    judged: bool = True  # False for a code's combination of simulated peaks
    peaks: tuple[Any, Any] | None = None  # [m], that a code combines

    @property
    def gap(self) -> float:
        """Largest gap over the heights [m], which is required over the whole height."""
        return float(np.max(self.gaps))

    @property
    def rho(self) -> float:
        """Correlation at the height where the gap is largest [-]; NaN if the rule has none."""
        defined = self.rhos is not None and not np.isnan(self.gap)
        return float(self.rhos[int(np.argmax(self.gaps))]) if defined else np.nan


def _check_source(
    peak_1: object, peak_2: object, modes_1: object, modes_2: object, spectrum: object
) -> None:
    """Raise a ValueError unless displacements are given once, as peaks or modes with a spectrum."""
    if (modes_1 is None) != (spectrum is None) or (modes_2 is not None and modes_1 is None):
        raise ValueError(
            "modes_1 and spectrum go together, and modes_2 with both; give what is missing"
        )
    if (peak_1 is None) == (modes_1 is None) or not (peak_2 is None or modes_1 is None):
        raise ValueError("peak_1 is missing, or given beside modes_1; allowed: one of both")


@checked
def code_gaps(
    peak_1: Parameter | None = None,
    peak_2: Parameter | None = None,
    *,
    height_1: Parameter | None = None,
    height_2: Parameter | None = None,
    floors_align: Truth = False,
    same_property: Truth = False,
    same_system: Truth = False,
    zone: Zone | None = None,
    storeys_1: Parameter | None = None,
    storeys_2: Parameter | None = None,
    design_pga: Parameter | None = None,
    numbers: Mapping[str, float] | None = None,
    behaviour_1: Parameter | None = None,
    behaviour_2: Parameter | None = None,
    deflection_1: Parameter | None = None,
    deflection_2: Parameter | None = None,
    importance_1: Parameter | None = None,
    importance_2: Parameter | None = None,
    modes_1: AnyStructure | None = None,
    modes_2: AnyStructure | None = None,
    spectrum: xr.DataArray | None = None,
    elastic: Truth | None = None,
    divided_by: DividedBy | None = None,
) -> xr.Dataset:
    """Separation of two buildings by every known rule of a building code.

    The rules include the four families of the paper: the square root of the sum of squares, a
    factor times the sum, a factor times the height, and a fixed distance.

    With the factors of a code it is the code as an engineer applies it: ``peak_1`` and ``peak_2``
    are then displacements under design forces, which each code multiplies by its factors. Without
    them the peaks are displacements as the code defines them.

    In place of peaks the modes of the buildings and an elastic design spectrum may be given. The
    peaks are then those of a response spectrum analysis of each building, at every height at which
    they could meet. Beside each code stands ``cqc``, the response spectrum analysis of both
    buildings together.

    Parameters
    ----------
    peak_1, peak_2 : float or array, optional
        Peak displacements [m], not negative, at the level where the buildings could meet. Each code
        defines its own displacement, see ``assumptions``. If ``peak_2`` is None, the gap is the
        distance of one building from its property line, for rules that define it.
    height_1, height_2 : float or array, optional
        Heights of the buildings [m].
    floors_align : bool
        Whether the floors are at the same levels, which reduces the gap in some rules.
    same_property : bool
        Whether no property line is between the buildings. Between two properties, the default, some
        codes ask for the sum of both distances from the line, and within one for less.
    same_system : bool
        Whether the structural systems are the same; for buildings of the same height and with level
        floors, this halves the gap in Mexico City.
    zone : str, optional
        Zone of Mexico City: ``"I"``, ``"II"`` or ``"III"``.
    storeys_1, storeys_2 : float or array, optional
        Numbers of storeys above the ground [-], at least 1, for Iran and Colombia.
    design_pga : float or array, optional
        Peak ground acceleration of the design at the site [m/s^2], positive: ``ag S`` of Italy.
    numbers : mapping, optional
        Numbers of rules by name, in place of their defaults, as in `stochlin.rules.code_rule`. With
        a number, ``"share_of_height"`` and ``"fixed_distance"`` [m] are also in the table.
    behaviour_1, behaviour_2 : float or array, optional
        Behaviour factor of each building [-], at least 1: ``q`` of Eurocode 8, ``R`` of UBC-97, IS
        1893 and TBDY 2018, ``Rd Ro`` of Canada, ``Q`` of Mexico City.
    deflection_1, deflection_2 : float or array, optional
        Displacement factor of each building [-], at least 1: ``Cd`` of ASCE 7 and Iran, ``1.4
        alpha_y Ra`` of Taiwan, ``0.75 R`` of Peru (0.85 if irregular), ``mu_d`` of Italy, ``mu`` of
        New Zealand.
    importance_1, importance_2 : float or array, optional
        Importance factor of each building [-], 0.5 to 2, by default 1. ASCE 7, Canada and TBDY 2018
        divide by it, and Iran asks for the displacement if it is above 1. ``ag`` of Eurocode 8
        contains it, so that it has no effect there.
    modes_1, modes_2 : ModalBuilding, ShearBuilding or oscillator, optional
        Buildings of which all modes are taken, as elastic, in place of peaks. If ``modes_2`` is
        None, it is one building beside its property line. Factors of codes then need
        ``behaviour_1`` and ``_2``, by which the spectrum is reduced to design forces.
    spectrum : DataArray, optional
        Elastic spectrum [m/s^2] over ``period`` [s], as from `eurocode_8`, `asce_7` and
        `read_spectrum`, given with ``modes_1``. It is taken as it is, also for modes with other
        damping ratios. A mode shorter than its shortest period has the ordinate there.
    elastic, divided_by : optional
        What a spectrum is that does not say so itself, as in `read_spectrum`.

    Returns
    -------
    xarray.Dataset
        Over ``rule`` and the dimensions of the arguments: ``gap`` [m], NaN for rules that lack an
        argument, and ``status``. Coordinates along ``rule`` are ``family`` (``SRSS``, ``sum``,
        ``height`` or ``fixed``), ``reference``, ``mark`` (S: seen in a copy of the source; P: in
        the text of the paper that was available; M: not compared with the source), ``assumptions``,
        and ``missing``, the arguments that the rule lacks. The attribute ``comment`` says which
        displacements the peaks are taken for.

        With modes the table is also over ``height`` [m], unless both structures are oscillators,
        and has ``peak_1`` and ``peak_2`` [m], the CQC of each building under the spectrum, and
        ``rho`` [-], the correlation of both. ``cqc`` [m], over ``rule``, is eq. (3) with ``rho``
        and the displacements of the code. It has no reduction for floors that align, and is NaN for
        rules without displacements.

    Raises
    ------
    ValueError, TypeError
        If the zone or a rule is unknown, a scalar is out of range, a value is not a number,
        dimensions do not match, or an importance factor is given without a factor on displacements.
        With modes, if peaks are given as well, the spectrum is missing or ends before the longest
        period, or heights contradict the storeys.

    Warns
    -----
    DoubtfulInput
        If modes have another damping ratio than the spectrum, or ``design_pga`` is above its
        plateau.

    Notes
    -----
    The table is a summary of one clause of each code for comparison. It does not replace the code.

    The modes ``i`` of both buildings have the spectral displacements ``D_i``, and ``d_i`` is the
    share of ``D_i`` by which a mode of building 1 closes the gap at the height, or, negative, by
    which one of building 2 opens it. Then ``cqc`` is the root of ``sum_ij d_i d_j rho_ij D_i D_j``
    over all modes of both, with the correlations ``rho_ij`` of the oscillators of the modes on
    white noise, eq. (4).

    References
    ----------
    The coordinate ``reference`` names the source of each rule. Der Kiureghian (1981), Earthquake
    Eng. Struct. Dyn. 9, for the CQC of one building.

    Examples
    --------
    >>> import stochlin as sl
    >>> table = sl.code_gaps(0.03, 0.04)
    >>> round(float(table.gap.sel(rule="eurocode_8")), 6)
    0.07
    >>> one_property = sl.code_gaps(0.03, 0.04, floors_align=True, same_property=True)
    >>> round(float(one_property.gap.sel(rule="eurocode_8")), 6)
    0.035
    >>> table.missing.sel(rule="peru_e030").item()
    'height_1, height_2'
    >>> applied = sl.code_gaps(0.01, 0.02, behaviour_1=3.0, behaviour_2=2.0)  # of design forces
    >>> round(float(applied.gap.sel(rule="eurocode_8")), 6)
    0.07
    >>> applied.missing.sel(rule="asce_7").item()
    'deflection_1 (deflection amplification factor Cd), deflection_2'
    >>> alone = sl.code_gaps(0.03, None, height_1=12.0, zone="II")  # from its property line
    >>> float(alone.gap.sel(rule="asce_7")), round(float(alone.gap.sel(rule="mexico_city")), 6)
    (0.03, 0.066)
    >>> stated = sl.code_gaps(
    ...     0.03, 0.04, height_1=12, height_2=20, numbers={"share_of_height": 0.01}
    ... )
    >>> float(stated.gap.sel(rule="share_of_height"))
    0.12
    >>> frame, wall = (
    ...     sl.ShearBuilding([2e5] * n, [k] * n, [3.0] * n, 0.05) for n, k in ((3, 2e8), (2, 3e8))
    ... )
    >>> spectrum = sl.eurocode_8(ag=2.5, soil="C")
    >>> by_modes = sl.code_gaps(modes_1=frame, modes_2=wall, spectrum=spectrum).sel(rule="srss")
    >>> by_modes.height.values.tolist(), by_modes.gap.round(4).values, by_modes.cqc.round(4).values
    ([3.0, 6.0], array([0.0218, 0.0384]), array([0.0215, 0.038 ]))
    """
    _check_source(peak_1, peak_2, modes_1, modes_2, spectrum)
    if spectrum is None:
        refuse("modes_1", "missing", {"elastic": elastic, "divided_by": divided_by})
    else:
        checked_spectrum(spectrum)
        spectrum = as_elastic(spectrum, elastic, divided_by)
        if is_number(design_pga) and (above := doubt_of_pga(spectrum, design_pga)):
            warnings.warn(f"design_pga = {design_pga:g} {above}", DoubtfulInput, stacklevel=3)
    codes = rules_with(numbers)
    if modes_1 is not None:  # until the displacements are known
        peak_1 = 0.0
        peak_2 = None if modes_2 is None else 0.0
    site = Site(
        peak_1=peak_1,
        peak_2=peak_2,
        height_1=height_1,
        height_2=height_2,
        floors_align=floors_align,
        zone=zone,
        same_property=same_property,
        same_system=same_system,
        storeys_1=storeys_1,
        storeys_2=storeys_2,
        importance_1=importance_1,
        importance_2=importance_2,
        design_pga=design_pga,
        behaviour_1=behaviour_1,
        behaviour_2=behaviour_2,
        deflection_1=deflection_1,
        deflection_2=deflection_2,
        elastic=modes_1 is not None,
    )
    if not site.of_design and not {"importance_1", "importance_2"}.isdisjoint(site.present):
        raise ValueError("importance is given alone; give behaviour_1 or deflection_1 as well")
    inputs = inputs_in_words(site, numbers)
    correlation = None
    models: dict[str, Model | None] = {"pair": site}
    if modes_1 is not None and spectrum is not None:
        both = [modes_1] if modes_2 is None else [modes_1, modes_2]
        site, correlation = spectral_peaks(both, spectrum, site)
        models = {"modes_1": modes_1, "modes_2": modes_2}
    valid = site.valid()
    site = site.with_arrays({name: array.where(valid) for name, array in site.arrays().items()})
    rules = [code_row(code, site) for code in codes]
    table = _table_of(rules, valid)
    if correlation is not None and spectrum is not None:
        table = table.assign(_by_modes(rules, site, correlation, valid))
        source = str(spectrum.attrs.get("source", "a spectrum"))
        table.attrs["spectrum"] = f"{source} ({taken_in_words(spectrum)})"
    table = labels.label(table)
    peaks = DESIGN_FORCES if site.of_design else DEFINED_BY_CODE
    if site.elastic:
        peaks += ELASTIC_PEAKS
    note = "Rules whose mark has an M were not compared with their source."
    table.attrs["comment"] = f"The peaks are {peaks}. {note}"
    return labels.with_run_information(
        table,
        f"{'Set-back' if site.alone else 'Separation'} by the rules of building codes",
        f"code_gaps({inputs})",
        {name: model for name, model in models.items() if model is not None},
        "; ".join(dict.fromkeys(rule.reference for rule in rules)),
    )


def _table_of(rules: Sequence[Rule], valid: xr.DataArray) -> xr.Dataset:
    """Gaps and status of all rules in the ``valid`` cells, with the texts of the rules."""
    usable = valid & xr.DataArray([not rule.missing for rule in rules], dims="rule")
    gap = _along_rules([rule.gaps for rule in rules], rules, valid)
    table = xr.Dataset({"gap": gap, "status": labels.status_where(usable).transpose(*gap.dims)})
    for name, text in CODE_TEXTS.items():
        entries = [getattr(rule, name).removeprefix(NEEDS) for rule in rules]
        table = table.assign_coords({name: ("rule", entries, {"long_name": text})})
    return table


def _by_modes(
    rules: Sequence[Rule], site: Site, correlation: xr.DataArray, valid: xr.DataArray
) -> dict[str, Any]:
    """The peaks of buildings by their modes and, of two, their correlation and the CQC of both."""
    if site.alone:
        return {"peak_1": site.peak_1}
    cqc = [_cqc_of_difference(rule.peaks, correlation) for rule in rules]
    return {
        "peak_1": site.peak_1,
        "cqc": _along_rules(cqc, rules, valid),
        "peak_2": site.peak_2,
        "rho": correlation,
    }


def inputs_in_words(site: Site, numbers: Mapping[str, float] | None) -> str:
    """What is true of both buildings, the zone and numbers of rules, for the run information."""
    inputs = {name: value for name in ("zone", *BOTH) if (value := getattr(site, name))}
    if numbers:
        inputs["numbers"] = {str(name): float(value) for name, value in numbers.items()}
    return ", ".join(f"{name}={value!r}" for name, value in inputs.items())


def _cqc_of_difference(peaks: tuple[Any, Any] | None, rho: xr.DataArray) -> Any:
    """CQC of the difference [m] with these peaks of both buildings; NaN without."""
    return np.nan if peaks is None else xr.apply_ufunc(equation_3, *peaks, rho)


def _along_rules(arrays: Sequence[Any], rules: Sequence[Rule], cells: xr.DataArray) -> xr.DataArray:
    """Arrays of all rules in one, over the rules and the dimensions of ``cells``."""
    name = xr.DataArray([rule.name for rule in rules], dims="rule", name="rule")
    rows = [xr.DataArray(array).broadcast_like(cells) for array in arrays]
    return xr.concat(rows, name.assign_attrs(long_name="rule"), coords="minimal", compat="override")


def code_row(rule: CodeRule, site: Site) -> Rule:
    """The row of a code: its gap, or what is missing for it."""
    missing = rule.missing(site)
    displaced = site if missing else rule.displaced(site)
    combines = not (site.alone or missing) and rule.takes_peaks()
    return Rule(
        rule.name,
        "code",
        np.nan if missing else rule.gap_of_displaced(displaced),
        family=rule.family if site.same_property else rule.between or rule.family,
        reference=rule.reference,
        mark=rule.mark,
        assumptions=rule.stated(site.alone),
        missing=f"{NEEDS}{', '.join(missing)}" if missing else "",
        judged=site.of_design or not rule.multiplies,
        peaks=(displaced.peak_1, displaced.peak_2) if combines else None,
    )


def rules_with(numbers: Mapping[str, float] | None) -> list[CodeRule]:
    """All rules in their order, with the given numbers of rules in place of their defaults."""
    if numbers is not None and not isinstance(numbers, Mapping):
        raise TypeError(
            f"numbers = {brief(numbers)}; allowed: a mapping from names of rules to numbers"
        )
    stated = {
        look_up(CODE_RULES, name, "a name in numbers").name: value
        for name, value in (numbers or {}).items()
    }
    usual = code_rule_names()
    names = [name for name in CODE_RULES if name in usual or name in stated]
    return [code_rule(name, stated.get(name)) for name in names]
