"""Options of commands in numbers: quantities with units, lists and sweeps, and models of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import MISSING, fields
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import brief

if TYPE_CHECKING:
    from stochlin.models.grounds import Ground
    from stochlin.models.structures import Structure

SWEEP = re.compile(r"(?P<start>[^:]+):(?P<stop>[^:]+):(?P<count>[2-9]|[1-9]\d{1,5})(?P<log>:log)?")


class QuantityType(click.ParamType):  # type: ignore[type-arg]  # no generic type before click 8.2
    """A number with its unit, as case files have it: ``5cm`` or ``"5 cm"``; ratios have none."""

    name = "quantity"

    def __init__(self, units: str) -> None:
        self.units = units

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The number in SI that a text stands for."""
        from stochlin.applications.cases.reading.kinds import WithUnit
        from stochlin.models.parameters import POSITIVE

        number = value
        with suppress(ValueError):
            number = float(value)
        try:
            return WithUnit(self.units, POSITIVE).in_si(number)  # models know the range
        except ValueError as error:
            self.fail(f"{brief(value)} {error}", param, ctx)


class OptionList(QuantityType):
    """A value ``0.5s``, a list ``0.5s,1s,2s``, or a sweep ``start:stop:count[:log]``."""

    name = "numbers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """A list of numbers in SI."""
        import numpy as np

        in_si = partial(super().convert, param=param, ctx=ctx)
        if ":" not in value:
            return [in_si(item) for item in value.split(",")]
        sweep = SWEEP.fullmatch(value)
        if not sweep:
            unit = "" if self.units == "1" else "s"
            allowed = (
                f"start:stop:count[:log], such as 0.2{unit}:2{unit}:19, with 2 to 999999 values"
            )
            self.fail(f"{brief(value)} is no sweep; allowed: {allowed}", param, ctx)
        low = in_si(sweep["start"])
        high = in_si(sweep["stop"])
        if sweep["log"] and not low * high > 0:
            self.fail(
                f"{value!r} is geometric and includes 0; allowed: both ends above 0", param, ctx
            )
        spaced = np.geomspace if sweep["log"] else np.linspace
        return spaced(low, high, int(sweep["count"])).tolist()


def numbers_option(
    name: str, help_text: str, units: str = "1", **more: Any
) -> Callable[[Any], Any]:
    """An option that takes a number, a list or a sweep, with these units."""
    shown: dict[str, Any] = {"metavar": "NUMBERS", "show_default": True, "help": help_text}
    return click.option(name, type=OptionList(units), **shown, **more)


def as_option(name: str) -> str:
    """A parameter as the option that gives it."""
    return f"--{name.replace('_', '-')}"


def parameter_of(name: str, options: dict[str, Any]) -> Any:
    """One number as a scalar; more as a dimension called like the option."""
    import xarray as xr

    values = options[name]
    if len(values) == 1:
        return values[0]
    units = {"units": "s" if "period" in name else "1"}
    return xr.DataArray(values, dims=name, coords={name: (name, values, units)})


def structures(options: dict[str, Any]) -> list[Structure]:
    """The two structures, which differ in their periods alone."""
    from stochlin.models.laws.bilinear import Bilinear

    names = "damping", "hardening", "reduction_factor"
    both = {name: parameter_of(name, options) for name in names if options[name]}
    return [Bilinear(parameter_of(f"period_{n}", options), **both) for n in (1, 2)]


def ground_of(options: dict[str, Any]) -> Ground:
    """The ground called for by name, with its period and its damping if it has them."""
    from stochlin.models.grounds import GROUNDS, ground_names, named_ground

    name = options["ground"]
    chosen = [option for option in ("ground_period", "ground_damping") if options[option]]
    values = {option.removeprefix("ground_"): parameter_of(option, options) for option in chosen}
    if name.strip().lower() in ground_names():
        return named_ground(name, **values)
    kind = GROUNDS.named(name, "--ground", ground_names())
    for field in fields(kind):
        if field.default is MISSING and field.name not in values:
            raise ValueError(f"--ground {name} needs {as_option(f'ground_{field.name}')}")
    return kind(**values)
