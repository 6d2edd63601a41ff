"""Options that commands share: numbers that may be sweeps, records, structures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.models.grounds import Ground
    from stochlin.models.structures import Bilinear

CLOSURES = ("gaussian", "clipped", "drift", "narrow_band")
STRUCTURE_OPTIONS = ("period", "damping", "hardening", "reduction_factor", "yield_displacement")
GROUND_OPTIONS = {
    "ground_period": "period",
    "ground_damping": "damping",
    "high_pass_period": "high_pass_period",
    "high_pass_damping": "high_pass_damping",
    "intensity": "intensity",
}


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

    def decorate(command: Any) -> Any:
        for number in (2, 1):
            command = numbers_option(f"--{name}-{number}", f"Of structure {number}.")(command)
        return numbers_option(f"--{name}", help_text, default)(command)

    return decorate


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
    return decorate(command, options)


def decorate(command: Any, options: Sequence[Callable[[Any], Any]]) -> Any:
    """The command with these options, in their order."""
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
    return decorate(command, options)


def structures(options: dict[str, Any]) -> tuple[Bilinear, Bilinear]:
    """The two bilinear structures; an option with a number goes before the shared one."""
    from stochlin.models.structures import Bilinear

    pair = []
    for number in (1, 2):
        values = {}
        for name in STRUCTURE_OPTIONS:
            own = options[f"{name}_{number}"]
            values[name] = parameter_of(
                name if own is None else f"{name}_{number}", options[name] if own is None else own
            )
        if values["period"] is None:
            raise click.UsageError(f"Missing option '--period-{number}' (or '--period' for both).")
        pair.append(Bilinear(**values))
    return pair[0], pair[1]


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
    wrong = [
        f"--{option.replace('_', '-')}"
        for option, m in GROUND_OPTIONS.items()
        if m in given and m not in names
    ]
    missing = [
        f"--{option.replace('_', '-')}"
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
