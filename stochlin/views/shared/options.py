"""Options that commands share: numbers that may be sweeps, closures, records and their grounds."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import MISSING
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import brief
from stochlin.views.shared.screen import FILE, bad_input

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.models.grounds import Ground

OF_BOTH = "damping", "hardening", "reduction_factor", "yield_displacement"
SWEEP = re.compile(r"(?P<start>[^:]+):(?P<stop>[^:]+):(?P<count>[2-9]|[1-9]\d{1,5})(?P<log>:log)?")


def together(*options: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """One decorator for several options, in their order."""
    return lambda command: reduce(lambda so_far, option: option(so_far), reversed(options), command)


class Extended(click.Command):
    """A command with further options after the one named ``after``, such as those of registered grounds.

    They are made when the command is asked for: the list of all commands does not wait for them.
    """

    def __init__(self, *args: Any, after: str, by: Callable[[], Iterable[Any]], **attrs: Any) -> None:
        super().__init__(*args, **attrs)
        self._after, self._by = after, by

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """All of them."""
        with bad_input():
            further = click.command("further")(together(*self._by())(lambda: None)).params
        usual = super().get_params(ctx)
        place = 1 + next(n for n, option in enumerate(usual) if option.name == self._after)
        return [*usual[:place], *further, *usual[place:]]


closure_option = click.option(
    "--closure",
    default="gaussian",
    show_default=True,
    help="Closure of the linearization: gaussian, clipped or drift.",
)


class QuantityType(click.ParamType):  # type: ignore[type-arg]  # no generic type before click 8.2
    """A number with its unit, as case files have it: ``5cm`` or ``"5 cm"``; ratios have none."""

    name = "quantity"

    def __init__(self, units: str) -> None:
        self.units = units

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """In SI."""
        return self.in_si(value, param, ctx) if isinstance(value, str) else value

    def in_si(self, text: str, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """The number that a text stands for."""
        from stochlin.applications.cases.reading.kinds import Quantity
        from stochlin.models.parameters import POSITIVE

        try:
            value: float | str = float(text)
        except ValueError:
            value = text
        try:
            return Quantity(self.units, POSITIVE).in_si(value)  # models know the range
        except ValueError as error:
            self.fail(f"{brief(text)} {error}", param, ctx)


class Numbers(QuantityType):
    """A value ``0.5s``, a list ``0.5s,1s,2s``, or a sweep ``start:stop:count[:log]``."""

    name = "numbers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """A list of numbers in SI."""
        import numpy as np

        if not isinstance(value, str):
            return value
        if ":" not in value:
            return [self.in_si(item, param, ctx) for item in value.split(",")]
        sweep = SWEEP.fullmatch(value)
        if not sweep:
            unit = "" if self.units == "1" else "s"
            self.fail(
                f"{brief(value)} is no sweep; allowed: start:stop:count with a count of 2 to 999999, "
                f"such as 0.2{unit}:2{unit}:19, or geometric, such as 0.2{unit}:4{unit}:81:log",
                param,
                ctx,
            )
        low, high = (self.in_si(sweep[end], param, ctx) for end in ("start", "stop"))
        if sweep["log"] and not low * high > 0:
            self.fail(f"{value!r} is geometric and includes 0; allowed: both ends above 0", param, ctx)
        return (np.geomspace if sweep["log"] else np.linspace)(low, high, int(sweep["count"])).tolist()


def numbers_option(name: str, help_text: str, units: str = "1", **more: Any) -> Callable[[Any], Any]:
    """An option that takes a number, a list or a sweep, with these units."""
    shown: dict[str, Any] = {"metavar": "NUMBERS", "show_default": True, "help": help_text}
    return click.option(name, type=Numbers(units), **shown, **more)


record_options = together(
    click.option("--record", type=FILE, help="Strong-motion record; the ground is fitted to it."),
    click.option(
        "--dt",
        type=QuantityType("s"),
        help="Time step of the record, such as 0.01s, if the file does not give it.",
    ),
    click.option("--units", help="Units of the record: g, m/s^2, cm/s^2 or mm/s^2."),
    click.option("--model", default="kanai_tajimi", show_default=True, help="Ground to fit."),
)


def site(record: Path, options: dict[str, Any]) -> tuple[xr.DataArray, Ground]:
    """The record and the ground fitted to it."""
    from stochlin.applications.records.records import read_record
    from stochlin.applications.sites.ground_fit import fit_ground

    motion = read_record(record, dt=options["dt"], units=options["units"])
    return motion, fit_ground(motion, options["model"])


def options_of_grounds() -> Iterable[Any]:
    """``--ground`` with the kinds that there are, and the numbers of every parameter that they have."""
    from stochlin.models.grounds import GROUNDS

    kinds = ", ".join(name.replace("_", "-") for name in GROUNDS)
    text = f"{kinds}, or a named ground such as firm or sct_1985_ns."
    yield click.option("--ground", default="white-noise", show_default=True, help=text)
    for option, grounds in parameters_of_grounds().items():
        kind = GROUNDS[grounds[0]]
        field = kind.__dataclass_fields__[kind.beside_structures()[option]]
        units, text = field.metadata["units"], field.metadata["long_name"].capitalize()
        text += "" if units == "1" else f" [{units}]"
        text += "." if len(grounds) == len(GROUNDS) else f" of {', '.join(grounds)}."
        yield numbers_option(as_option(option), text, units)


def parameters_of_grounds() -> dict[str, list[str]]:
    """Parameters of grounds as options name them, and the names of the grounds that have them."""
    from stochlin.models.grounds import GROUNDS

    grounds: dict[str, list[str]] = {}
    for name, kind in GROUNDS.items():
        for option in kind.beside_structures():
            grounds.setdefault(option, []).append(name)
    return grounds


def structures(options: dict[str, Any]) -> list[Any]:
    """The two structures."""
    from stochlin.models.laws.bilinear import Bilinear

    both = {name: parameter_of(name, options) for name in OF_BOTH if options[name] is not None}
    return [Bilinear(parameter_of(f"period_{n}", options), **both) for n in (1, 2)]


def ground_of(options: dict[str, Any]) -> Ground:
    """The ground called for by name, with its parameters."""
    from stochlin.models.grounds import GROUNDS
    from stochlin.models.grounds.named import ground_names, named_ground
    from stochlin.registry import as_key

    if options["intensity"] is None and options["yield_displacement"]:
        raise click.UsageError(
            "--yield-displacement needs the strength of the shaking: give --intensity as well, or "
            "--reduction-factor in its place"
        )
    name = options["ground"]
    kind = GROUNDS.get(as_key(name))
    if kind is None and name.strip().lower() not in ground_names():
        allowed = ", ".join([*GROUNDS, *ground_names()])
        raise ValueError(f"--ground {brief(name)} is not known; allowed: {allowed}")
    parameters = {"intensity": "intensity"} if kind is None else kind.beside_structures()
    chosen = {option for option in parameters_of_grounds() if options[option] is not None}
    if wrong := chosen - {*parameters}:
        raise click.UsageError(f"{as_option(min(wrong))} does not apply to --ground {name}.")
    values = {parameters[option]: parameter_of(option, options) for option in chosen}
    if kind is None:
        return named_ground(name, **values)
    fields = kind.__dataclass_fields__
    for option, parameter in parameters.items():
        if option not in chosen and fields[parameter].default is MISSING:
            raise click.UsageError(f"--ground {name} needs {as_option(option)}.")
    return kind(**values)


def as_option(name: str) -> str:
    """A parameter as the option that gives it."""
    return f"--{name.replace('_', '-')}"


def parameter_of(name: str, options: dict[str, Any]) -> Any:
    """One number as a scalar; more as a dimension called like the option."""
    import xarray as xr

    values = options[name]
    if len(values) == 1:
        return values[0]
    units = "s" if "period" in name else "m" if "displacement" in name else "1"
    return xr.DataArray(values, dims=name, coords={name: (name, values, {"units": units})})
