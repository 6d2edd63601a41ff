"""Options that commands share: numbers that may be sweeps, records, structures."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import brief
from stochlin.views.shared.screen import FILE, bad_input

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.models.grounds import Ground
    from stochlin.models.structures import Structure

STRUCTURE_OPTIONS = ("period", "damping", "hardening", "reduction_factor", "yield_displacement")


class Names(click.Choice):  # type: ignore[type-arg]  # no generic type before click 8.2
    """One of the names that a module lists: it is asked when they are needed, so that no start waits."""

    def __init__(self, module: str, listed: str) -> None:
        self.module, self.listed, self.case_sensitive = module, listed, False

    @property
    def choices(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names: of a mapping, or what a function returns."""
        names = getattr(import_module(self.module), self.listed)
        return tuple(names() if callable(names) else names)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name; ``-`` stands for ``_``, as in the names of options."""
        return super().convert(str(value).replace("-", "_"), param, ctx)


def together(*options: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """One decorator for several options, in their order."""
    return lambda command: reduce(lambda so_far, option: option(so_far), reversed(options), command)


class Extended(click.Command):
    """A command with further options after one of its own, for what is registered.

    They are made when the command is asked for: the list of all commands does not wait for them.
    """

    def __init__(
        self, *args: Any, after: str, by: Sequence[Callable[[], Iterable[Any]]], **attrs: Any
    ) -> None:
        super().__init__(*args, **attrs)
        self._after, self._by = after, by

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """All of them."""
        with bad_input():
            made = together(*(option for make in self._by for option in make()))
        further = click.command("further")(made(lambda: None)).params
        own = super().get_params(ctx)
        place = 1 + next(n for n, option in enumerate(own) if option.name == self._after)
        return [*own[:place], *further, *own[place:]]


closure_option = click.option(
    "--closure",
    type=Names("stochlin.models.laws", "closure_names"),
    default="gaussian",
    show_default=True,
)

solver_option = click.option(
    "--solver",
    type=Names("stochlin.solver.correlation.correlation", "SOLVERS"),
    default="closed_form",
    show_default=True,
    help="Of the linearized pairs: formulas, or the Lyapunov equation of each pair, iterated.",
)


class QuantityType(click.ParamType):  # type: ignore[type-arg]  # no generic type before click 8.2
    """A number with its unit, as case files have it: ``5cm`` or ``"5 cm"``; ratios have none."""

    name = "quantity"

    def __init__(self, units: str) -> None:
        self.units = units

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """In SI."""
        return self.one(value, param, ctx) if isinstance(value, str) else value

    def one(self, text: str, param: click.Parameter | None, ctx: click.Context | None) -> float:
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

        from stochlin.solver.tables.work import check_work

        if not isinstance(value, str):
            return value
        if ":" not in value:
            return [self.one(item, param, ctx) for item in value.split(",")]
        start, stop, *rest = value.split(":")
        if not re.fullmatch(r"\d{1,18}(:log)?", ":".join(rest)) or int(rest[0]) < 2:
            unit = "" if self.units == "1" else "s"
            self.fail(
                f"{brief(value)} is no sweep; allowed: start:stop:count with count >= 2, such as "
                f"0.2{unit}:2{unit}:19, or geometric, such as 0.2{unit}:4{unit}:81:log",
                param,
                ctx,
            )
        try:
            check_work(f"{value!r} takes", "take fewer points", numbers=12 * float(rest[0]))
        except ValueError as error:
            self.fail(str(error), param, ctx)
        low, high = (self.one(end, param, ctx) for end in (start, stop))
        if rest[1:] and not low * high > 0:
            self.fail(f"{value!r} is geometric and includes 0; allowed: both ends above 0", param, ctx)
        return (np.geomspace if rest[1:] else np.linspace)(low, high, int(rest[0])).tolist()


def numbers_option(
    name: str, help_text: str = "", default: str | None = None, units: str = "1"
) -> Callable[[Any], Any]:
    """An option that takes a number, a list or a sweep, with these units; hidden without a text."""
    shown: dict[str, Any] = {
        "default": default,
        "show_default": True,
        "help": help_text,
        "hidden": not help_text,
    }
    return click.option(name, type=Numbers(units), metavar="NUMBERS", **shown)


def ground_options() -> dict[str, list[str]]:
    """Parameters of grounds as options name them, and the names of the grounds that have them."""
    from stochlin.models.grounds import GROUNDS

    grounds: dict[str, list[str]] = {}
    for name, kind in GROUNDS.items():
        for option in kind.beside_structures():
            grounds.setdefault(option, []).append(name.replace("_", "-"))
    return {option: grounds[option] for option in sorted(grounds, key=lambda name: name == "intensity")}


def ground_option() -> Iterable[Any]:
    """``--ground``, with the kinds that there are."""
    from stochlin.models.grounds import GROUNDS

    kinds = ", ".join(name.replace("_", "-") for name in GROUNDS)
    text = f"{kinds}, or a named ground such as firm or sct_1985_ns."
    yield click.option("--ground", default="white-noise", show_default=True, help=text)


def options_of_grounds() -> Iterable[Any]:
    """An option for the numbers of every parameter that a ground has."""
    from stochlin.models.grounds import GROUNDS

    for name, kinds in ground_options().items():
        kind = GROUNDS.named(kinds[0])
        field = kind.__dataclass_fields__[kind.beside_structures()[name]]
        about, default = field.metadata, field.default
        text = about["long_name"][0].upper() + about["long_name"][1:]
        text += "" if about["units"] == "1" else f" [{about['units']}]"
        text += f"; {default:g} if not given" if isinstance(default, float) else ""
        text += "." if len(kinds) == len(GROUNDS) else f"; of {', '.join(kinds)}."
        yield numbers_option(_flags([name]), text, units=about["units"])


def shared_option(
    name: str, help_text: str = "", default: str | None = None, units: str = "1"
) -> Callable[[Any], Any]:
    """``--name`` for both structures, and ``--name-1``, ``--name-2`` for one."""
    of_one = (numbers_option(f"--{name}-{n}", units=units) for n in (1, 2))
    return together(numbers_option(f"--{name}", help_text, default, units), *of_one)


_LAWS = Names("stochlin.models.laws", "laws_in_numbers")
law_options = together(
    click.option("--law", type=_LAWS, default="bilinear", show_default=True, help="Hysteresis law."),
    *(click.option(f"--law-{n}", type=_LAWS, hidden=True) for n in (1, 2)),
)


def options_of_laws() -> Iterable[Any]:
    """Options for every parameter that a law has of its own."""
    return (
        shared_option(name.replace("_", "-"), units=units) for name, units in own_parameters().items()
    )


def own_parameters() -> dict[str, str]:
    """Parameters that one law has and not every structure, with their units."""
    from stochlin.models.laws import laws_in_numbers

    return {
        field.name: field.metadata["units"]
        for law in laws_in_numbers().values()
        for field in dataclasses.fields(law)
        if field.name in law.own_parameters()
    }


simulation_options = together(
    click.option(
        "--paths",
        type=click.IntRange(min=2),
        default=256,
        show_default=True,
        help="Number of simulated motions, with --method simulation.",
    ),
    click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True),
)

record_options = together(
    click.option("--record", type=FILE, help="Strong-motion record; the ground is fitted to it."),
    click.option(
        "--dt",
        type=QuantityType("s"),
        help="Time step of the record, such as 0.01s, if the file does not give it.",
    ),
    click.option("--units", help="Units of the record: g, m/s^2, cm/s^2 or mm/s^2."),
    click.option(
        "--model",
        type=Names("stochlin.applications.records.ground_fit", "fitted_grounds"),
        default="kanai_tajimi",
        show_default=True,
        help="Ground to fit.",
    ),
)


def structures(options: dict[str, Any]) -> tuple[Structure, Structure]:
    """The two structures; an option with a number goes before the shared one."""
    from stochlin.models.laws import laws_in_numbers

    def chosen(name: str, number: int) -> str:
        """The option that counts for this structure."""
        return name if options[f"{name}_{number}"] is None else f"{name}_{number}"

    laws = [options[chosen("law", number)] for number in (1, 2)]
    kinds = [laws_in_numbers()[law] for law in laws]
    for name in own_parameters():
        has = [name in kind.own_parameters() for kind in kinds]
        for option, fits in ((name, any(has)), (f"{name}_1", has[0]), (f"{name}_2", has[1])):
            if options[option] is not None and not fits:
                chosen_laws = " and ".join(dict.fromkeys(laws))
                raise click.UsageError(f"{_flags([option])} does not apply to --law {chosen_laws}.")
    pair = []
    for number, kind in enumerate(kinds, start=1):
        names = (*STRUCTURE_OPTIONS, *kind.own_parameters())
        values = {
            name: parameter_of(option, options[option])
            for name in names
            if options[option := chosen(name, number)] is not None
        }
        if "period" not in values:
            raise click.UsageError(f"Missing option '--period-{number}' (or '--period' for both).")
        pair.append(kind(**values))
    return pair[0], pair[1]


def ground(options: dict[str, Any]) -> Ground:
    """The ground called for by name, with its parameters."""
    from dataclasses import MISSING

    from stochlin.models.grounds import GROUNDS
    from stochlin.models.grounds.named import ground_names, named_ground
    from stochlin.registry import as_key

    chosen = options["ground"]
    kind = GROUNDS.get(as_key(chosen))
    own = {"intensity": "intensity"} if kind is None else kind.beside_structures()
    present = {name: options[name] for name in ground_options() if options[name] is not None}
    wrong = [name for name in present if name not in own]
    if kind is None and chosen.strip().lower() not in ground_names():
        allowed = [*(name.replace("_", "-") for name in GROUNDS), *ground_names()]
        raise ValueError(f"--ground {brief(chosen)} is not known; allowed: {', '.join(allowed)}")
    if wrong:
        raise click.UsageError(f"{_flags(wrong)} does not apply to --ground {chosen}.")
    values = {own[name]: parameter_of(name, numbers) for name, numbers in present.items()}
    if kind is None:
        return named_ground(chosen, **values)
    fields = kind.__dataclass_fields__
    missing = [n for n, model in own.items() if n not in present and fields[model].default is MISSING]
    if missing:
        raise click.UsageError(f"--ground {chosen} needs {_flags(missing)}.")
    return kind(**values)


def _flags(names: Iterable[str]) -> str:
    return ", ".join(f"--{name.replace('_', '-')}" for name in names)


def site(record: Path, options: dict[str, Any]) -> tuple[xr.DataArray, Ground]:
    """The record and the ground fitted to it."""
    from stochlin.applications.records.records import read_record
    from stochlin.applications.sites.ground_fit import fit_ground

    motion = read_record(record, dt=options["dt"], units=options["units"])
    return motion, fit_ground(motion, options["model"])


def parameter_of(name: str, values: list[float]) -> Any:
    """One number as a scalar; more as a dimension called like the option."""
    import xarray as xr

    if len(values) == 1:
        return values[0]
    units = "s" if "period" in name else "m" if "displacement" in name else "1"
    return xr.DataArray(values, dims=name, coords={name: (name, values, {"units": units})})
