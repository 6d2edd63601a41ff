"""Options that commands share: numbers that may be sweeps, records, structures."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.charts.design import ChartSettings
    from stochlin.models.grounds import Ground
    from stochlin.models.structures import Structure

STRUCTURE_OPTIONS = ("period", "damping", "hardening", "reduction_factor", "yield_displacement")
GROUND_OPTIONS = {
    "ground_period": "period",
    "ground_damping": "damping",
    "high_pass_period": "high_pass_period",
    "high_pass_damping": "high_pass_damping",
    "intensity": "intensity",
}


class Names(click.Choice[str]):
    """One of the names that a module lists: it is asked when they are needed, so that no start waits."""

    def __init__(self, module: str, listed: str) -> None:
        self.module, self.listed, self.case_sensitive = module, listed, False

    @property
    def choices(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names: of a mapping, or what a function returns."""
        names = getattr(import_module(self.module), self.listed)
        return tuple(names() if callable(names) else names)


closure_option = click.option(
    "--closure",
    type=Names("stochlin.models.laws", "closure_names"),
    default="gaussian",
    show_default=True,
)


def _numbers(context: click.Context, option: click.Parameter, text: str | None) -> list[float] | None:
    """A value ``0.5``, a list ``0.5,1,2``, or a sweep ``start:stop:count[:log]``."""
    if text is None:
        return None
    import numpy as np

    try:
        if ":" not in text:
            return [float(item) for item in text.split(",")]
        start, stop, count, *kind = text.split(":")
        if kind not in ([], ["log"]) or int(count) < 2:
            raise ValueError
        spread = np.geomspace if kind else np.linspace
        return [float(x) for x in spread(float(start), float(stop), int(count))]
    except ValueError as error:
        raise click.BadParameter(
            f"{text!r} is not a number; allowed: 0.5, a list 0.5,1,2, or a sweep start:stop:count "
            "with count >= 2, as 0.2:2:19, or geometric as 0.2:4:81:log"
        ) from error


def numbers_option(name: str, help_text: str, default: str | None = None) -> Callable[[Any], Any]:
    """An option that takes a number, a list or a sweep."""
    return click.option(
        name, callback=_numbers, metavar="NUMBERS", default=default, show_default=True, help=help_text
    )


def shared_option(name: str, help_text: str, default: str | None = None) -> Callable[[Any], Any]:
    """``--name`` for both structures, and ``--name-1``, ``--name-2`` for one."""
    return lambda command: _decorate(
        command,
        (
            numbers_option(f"--{name}", help_text, default),
            *(numbers_option(f"--{name}-{n}", f"Of structure {n}.") for n in (1, 2)),
        ),
    )


def law_options(command: Any) -> Any:
    """``--law``, ``--law-1``, ``--law-2``; of a `LawCommand`, which adds the laws' own parameters."""
    kind = Names("stochlin.models.laws", "laws_in_numbers")
    options = (
        click.option("--law", type=kind, default="bilinear", show_default=True, help="Hysteresis law."),
        *(click.option(f"--law-{n}", type=kind, help=f"Of structure {n}.") for n in (1, 2)),
    )
    return _decorate(command, options)


class LawCommand(click.Command):
    """A command with an option for every parameter that a law has of its own."""

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """All of them; those of the laws after ``--law-2``."""

        def holder() -> None: ...

        for name, told in reversed(own_parameters().items()):
            shared_option(name.replace("_", "-"), told)(holder)
        own: list[click.Parameter] = getattr(holder, "__click_params__", [])
        given = super().get_params(ctx)
        place = 1 + next(n for n, option in enumerate(given) if option.name == "law_2")
        return [*given[:place], *reversed(own), *given[place:]]


def own_parameters() -> dict[str, str]:
    """Parameters that one law has and not every structure, and what they are."""
    from stochlin.models.laws import laws_in_numbers

    told: dict[str, list[str]] = {}
    for name, law in laws_in_numbers().items():
        for field in dataclasses.fields(law):
            if field.name in law.own_parameters():
                usual = getattr(law, field.name, None)  # a class has what is usual, if anything is
                usual = "" if usual is None else f", {usual:g} if not given"
                what = f"{field.metadata['long_name']}, of {name}{usual}"
                told.setdefault(field.name, []).append(what)
    return {name: f"{'; '.join(texts)}." for name, texts in told.items()}


def chart_options(points: int, reduction_factors: str) -> Callable[[Any], Any]:
    """Where charts go and what they take as given."""
    folder = click.Path(file_okay=False, path_type=Path)
    numbers = (
        ("--damping", 0.05, "Damping ratio of the structures."),
        ("--hardening", 0.05, "Hardening ratio."),
        ("--plane-reduction-factor", 4.0, "R of Fig. 5a."),
        ("--ground-period", 2.0, "Period of the model grounds [s]."),
    )
    options = (
        click.option(
            "--out", type=folder, default="figures", show_default=True, help="Folder for the files."
        ),
        click.option(
            "--format",
            "picture_format",
            type=click.Choice(["png", "svg", "pdf"]),
            default="png",
            show_default=True,
        ),
        *(
            click.option(name, type=float, default=default, show_default=True, help=text)
            for name, default, text in numbers
        ),
        numbers_option("--reduction-factors", "R of the curves in Figs. 4 and 5b.", reduction_factors),
        closure_option,
        click.option(
            "--points",
            type=click.IntRange(min=2),
            default=points,
            show_default=True,
            help="Periods along an axis.",
        ),
    )
    return lambda command: _decorate(command, options)


def simulation_options(command: Any) -> Any:
    """How to simulate."""
    options = (
        click.option(
            "--paths",
            type=click.IntRange(min=2),
            default=256,
            show_default=True,
            help="Simulated motions, where the method is simulation.",
        ),
        click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True),
    )
    return _decorate(command, options)


def chart_settings(options: dict[str, Any]) -> ChartSettings:
    """The settings of charts among the options of a command."""
    from stochlin.analyses.charts.design import ChartSettings

    names = {field.name for field in dataclasses.fields(ChartSettings)}
    chosen = {key: value for key, value in options.items() if key in names}
    return ChartSettings(**chosen | {"reduction_factors": tuple(options["reduction_factors"])})


def _decorate(command: Any, options: Sequence[Callable[[Any], Any]]) -> Any:
    for option in reversed(options):
        command = option(command)
    return command


def record_options(command: Any) -> Any:
    """Options of a record and the ground fitted to it."""
    options = (
        click.option(
            "--record",
            type=click.Path(dir_okay=False, path_type=Path),
            help="Strong-motion record; the ground is fitted to it.",
        ),
        click.option(
            "--dt", type=float, help="Time step of the record [s], where the file does not say."
        ),
        click.option("--units", help="Units of the record: g, m/s^2, cm/s^2 or mm/s^2."),
        click.option("--column", help="Column of the record, by number from 0 or by name."),
        click.option("--time-column", help="Column of the time, likewise."),
        click.option(
            "--model",
            type=click.Choice(["kanai_tajimi", "clough_penzien"]),
            default="kanai_tajimi",
            show_default=True,
            help="Ground to fit.",
        ),
        click.option(
            "--estimator",
            default="psd",
            show_default=True,
            help="How it is fitted: psd, log_psd, whittle.",
        ),
    )
    return _decorate(command, options)


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
                told = " and ".join(dict.fromkeys(laws))
                raise click.UsageError(f"{_flag(option)} does not apply to --law {told}.")
    pair = []
    for number, kind in enumerate(kinds, start=1):
        names = (*STRUCTURE_OPTIONS, *kind.own_parameters())
        given = {name: chosen(name, number) for name in names}
        values = {
            name: parameter_of(option, options[option])
            for name, option in given.items()
            if options[option] is not None
        }
        if "period" not in values:
            raise click.UsageError(f"Missing option '--period-{number}' (or '--period' for both).")
        pair.append(kind(**values))
    return pair[0], pair[1]


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def ground(options: dict[str, Any]) -> Ground:
    """The ground called for by name, with its parameters."""
    from stochlin.models.grounds import CloughPenzien, KanaiTajimi, WhiteNoise
    from stochlin.models.named_grounds import named_ground

    given = {
        model_name: parameter_of(option, options[option])
        for option, model_name in GROUND_OPTIONS.items()
        if options[option] is not None
    }
    kinds: dict[str, type[Ground]] = {
        "white-noise": WhiteNoise,
        "kanai-tajimi": KanaiTajimi,
        "clough-penzien": CloughPenzien,
    }
    kind = kinds.get(options["ground"])
    if kind is None and set(given) <= {"intensity"}:
        return named_ground(options["ground"], **given)
    names = {"intensity"} if kind is None else {*kind.parameter_names()}
    wrong = [_flag(option) for option, m in GROUND_OPTIONS.items() if m in given and m not in names]
    missing = [
        _flag(option)
        for option, m in GROUND_OPTIONS.items()
        if m in names and m not in given and m != "intensity"
    ]
    if kind is None or wrong:
        raise click.UsageError(f"{', '.join(wrong)} does not apply to --ground {options['ground']}.")
    if missing:
        raise click.UsageError(f"--ground {options['ground']} needs {', '.join(missing)}.")
    return kind(**given)


def site(record: Path, options: dict[str, Any]) -> tuple[xr.DataArray, Ground]:
    """The record and the ground fitted to it."""
    from stochlin.analyses.records.ground_fit import fit_ground
    from stochlin.analyses.records.records import read_record

    columns = {
        name: int(value) if value is not None and value.isdigit() else value
        for name, value in ((n, options[n]) for n in ("column", "time_column"))
    }
    motion = read_record(record, dt=options["dt"], units=options["units"], **columns)
    return motion, fit_ground(motion, options["model"], options["estimator"])


def parameter_of(name: str, values: list[float] | None) -> Any:
    """One number as a scalar; more as a dimension called like the option."""
    import xarray as xr

    if values is None or len(values) == 1:
        return values and values[0]
    return xr.DataArray(values, dims=name, coords={name: values})
