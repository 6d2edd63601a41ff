"""Case files: a site, two buildings and a motion, described in TOML."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.case_values import Quantity, Section, read_sections
from stochlin.analyses.ground_fit import fit_ground
from stochlin.analyses.record_spectra import ESTIMATORS
from stochlin.analyses.records import read_record
from stochlin.analyses.strength import DuctilityTarget, strength_for_ductility
from stochlin.models.envelopes import AminAng, Envelope, GammaEnvelope, ShinozukaSato
from stochlin.models.grounds import CloughPenzien, Ground, KanaiTajimi, WhiteNoise
from stochlin.models.named_grounds import ground_names, named_ground
from stochlin.models.parameters import Model, Range
from stochlin.models.separation_rules import ZONES
from stochlin.models.structures import POSITIVE, Bilinear

FITTED, NONE = "fitted", "none"
FITS: Mapping[str, type[Ground]] = {"kanai_tajimi": KanaiTajimi, "clough_penzien": CloughPenzien}
GROUNDS: Mapping[str, type[Ground]] = {**FITS, "white_noise": WhiteNoise}
ENVELOPES: Mapping[str, type[Envelope]] = {
    "amin_ang": AminAng,
    "shinozuka_sato": ShinozukaSato,
    "gamma": GammaEnvelope,
}
STRENGTHS = ("reduction_factor", "yield_displacement", "ductility", "elastic")
TIME, LENGTH = Quantity("s", POSITIVE), Quantity("m", POSITIVE)
SHARE = Quantity("1", Range(upper=1.0, reason="a probability"))
FEWEST_PATHS = 100  # for a quantile to have an interval


@dataclass(frozen=True)
class Building:
    """One of the two buildings of a case.

    ``strength`` says by which key the file gives it; ``height`` [m] and ``storeys`` may be unknown.
    """

    name: str
    structure: Bilinear
    strength: str
    height: float | None
    storeys: int | None


@dataclass(frozen=True)
class Case:
    """What a case file describes, in SI; ``file`` is its name, ``gap`` [m] the one that exists."""

    file: str
    title: str
    site: str  # the file's word for the ground
    ground: Ground
    first: Building
    second: Building
    duration: float
    envelope: Envelope | None
    records: Mapping[str, xr.DataArray]
    confidence: float
    gap: float | None
    floors_align: bool
    zone: str | None
    unverified: bool
    paths: int
    seed: int

    @property
    def fitted(self) -> bool:
        """Whether the ground is fitted to the first record."""
        return self.site == FITTED

    @property
    def buildings(self) -> tuple[Building, Building]:
        """Both, the left one first."""
        return self.first, self.second


def example_case() -> str:
    """Text of a case file, with comments, to start from.

    Returns
    -------
    str
        As ``stochlin gap --example`` prints it.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.example_case().splitlines()[0]
    '# How far must two buildings stand apart? A case for'
    """
    return files("stochlin.analyses").joinpath("example_case.toml").read_text(encoding="utf-8")


def read_case(path: str | os.PathLike[str]) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or path
        The file, TOML as `example_case` shows it. Values with a unit are texts, ``"0.8 s"``; paths of
        records are relative to the file. Nothing in it is evaluated.

    Returns
    -------
    Case
        With ``ground``, ``first`` and ``second`` (each with its ``structure``), ``duration`` [s],
        ``envelope``, ``records``, ``confidence``, ``gap`` [m] and the rest, as `separation` takes them.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the file is no TOML; if a key is unknown or missing, a unit missing or unknown, a number
        no number or out of range, a building without a strength or with two; or if a record cannot be
        read or fitted. The message names file, line and key, and what is allowed.

    Examples
    --------
    >>> import pathlib, tempfile, stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "case.toml"
    >>> _ = path.write_text(sl.example_case(), encoding="utf-8")
    >>> case = sl.read_case(path)
    >>> case.second.name, case.second.structure.period, case.gap
    ('Annex', 0.6, 0.05)
    """
    path = Path(path)
    whole = read_sections(path)
    whole.only("title", "site", "motion", "building_1", "building_2", "separation", "simulation")
    site, motion, wanted = (whole.section(key) for key in ("site", "motion", "separation"))
    wanted.only("confidence", "existing", "floors_align", "zone", "unverified")
    records = _records(site, path.parent)
    ground = _ground(site, records)
    first, second = (_building(whole.section(f"building_{n}"), n, ground) for n in (1, 2))
    envelope = _envelope(motion)
    paths, seed = _simulation(whole)
    return Case(
        file=path.name,
        title=whole.text("title") if "title" in whole else f"{first.name} and {second.name}",
        site=site.text("ground"),
        ground=ground,
        first=first,
        second=second,
        duration=motion.number("duration", TIME),
        envelope=envelope,
        records=records,
        confidence=wanted.number("confidence", SHARE),
        gap=wanted.number("existing", LENGTH) if "existing" in wanted else None,
        floors_align=wanted.truth("floors_align"),
        zone=wanted.text("zone", tuple(ZONES)) if "zone" in wanted else None,
        unverified=wanted.truth("unverified"),
        paths=paths,
        seed=seed,
    )


def _model(section: Section, kind: type[Model], names: tuple[str, ...]) -> Any:
    """A model from those of its parameters that the file has to give."""
    declared = {field.name: field.metadata for field in dataclasses.fields(kind)}
    values = {}
    for name in names:
        units, allowed = declared[name]["units"], declared[name]["allowed"]
        values[name] = section.number(name, Quantity(units, allowed))
    try:
        return kind(**values)
    except ValueError as error:  # of values that do not fit one another
        raise section.error("", f"does not fit: {error}") from error


def _records(site: Section, folder: Path) -> dict[str, xr.DataArray]:
    records: dict[str, xr.DataArray] = {}
    for one in site.sections("records"):
        one.only("path", "name", "units", "dt", "column", "time_column")
        path = one.text("path")
        name = one.text("name") if "name" in one else Path(path).name
        options: dict[str, Any] = {"units": one.text("units")} if "units" in one else {}
        if "dt" in one:
            options["dt"] = one.number("dt", TIME)
        for key in ("column", "time_column"):
            if key in one:
                known = isinstance(one.values[key], str)
                options[key] = one.text(key) if known else one.whole(key, 0)
        if name in records:
            raise one.error("name" if "name" in one else "path", "is there twice; give it another name")
        try:
            records[name] = read_record(folder / path, **options)
        except (OSError, ValueError) as error:
            raise one.error("path", f"cannot be read: {error}") from error
    return records


def _ground(site: Section, records: Mapping[str, xr.DataArray]) -> Ground:
    kinds = (*ground_names(), *GROUNDS, FITTED)
    name = site.text("ground", kinds)
    if name == FITTED:
        site.only("ground", "records", "model", "estimator")
        model = site.text("model", tuple(FITS)) if "model" in site else "kanai_tajimi"
        estimator = site.text("estimator", tuple(ESTIMATORS)) if "estimator" in site else "psd"
        if not records:
            raise site.error("ground", "needs a record to be fitted to; allowed: a [[site.records]]")
        try:
            return fit_ground(next(iter(records.values())), model, estimator)
        except ValueError as error:
            raise site.error("ground", f"cannot be fitted to {next(iter(records))}: {error}") from error
    names = GROUNDS[name].parameter_names() if name in GROUNDS else ("intensity",)
    site.only("ground", "records", *names)
    if name in GROUNDS:
        ground: Ground = _model(site, GROUNDS[name], names)
        return ground
    intensity = _model(site, WhiteNoise, ("intensity",)).intensity
    return named_ground(name, intensity)


def _envelope(motion: Section) -> Envelope | None:
    name = motion.text("envelope", (*ENVELOPES, NONE)) if "envelope" in motion else NONE
    names = () if name == NONE else ENVELOPES[name].parameter_names()
    motion.only("duration", "envelope", *names)
    envelope: Envelope | None = None if name == NONE else _model(motion, ENVELOPES[name], names)
    return envelope


def _building(one: Section, number: int, ground: Ground) -> Building:
    one.only("name", "period", "damping", "hardening", *STRENGTHS, "height", "storeys")
    elastic = one.truth("elastic")
    given = [key for key in STRENGTHS if key in one and (key != "elastic" or elastic)]
    if len(given) != 1:
        count = f"strength is given {len(given)} times, by {' and '.join(given)}"
        raise one.error(
            given[1] if given else "",
            f"{': ' if given else 'has no strength'}{count if given else ''}; allowed: one of "
            'reduction_factor = 4, yield_displacement = "3 cm", ductility = 4, elastic = true',
        )
    (strength,) = given
    names = ("period", "damping") if elastic else ("period", "damping", "hardening")
    if strength in ("reduction_factor", "yield_displacement"):
        names = (*names, strength)
    structure: Bilinear = _model(one, Bilinear, names)
    if strength == "ductility":
        wanted = _model(one, DuctilityTarget, ("ductility",)).ductility
        try:
            found = strength_for_ductility(structure, ground, wanted)
        except ArithmeticError as error:
            raise one.error("ductility", f"has no strength ({error}); give another one") from error
        structure = dataclasses.replace(structure, reduction_factor=float(found.reduction_factor))
    return Building(
        name=one.text("name") if "name" in one else f"Building {number}",
        structure=structure,
        strength=strength,
        height=one.number("height", LENGTH) if "height" in one else None,
        storeys=one.whole("storeys", 1) if "storeys" in one else None,
    )


def _simulation(whole: Section) -> tuple[int, int]:
    settings = {"paths": 2048, "seed": 0}
    if "simulation" in whole:
        given = whole.section("simulation")
        given.only(*settings)
        lowest = {"paths": FEWEST_PATHS, "seed": 0}
        settings |= {key: given.whole(key, lowest[key]) for key in given.values}
    return settings["paths"], settings["seed"]
