"""Histories of buildings in a row that pound against each other in a recorded motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.pounding.estimates import pounding_estimate
from stochlin.analyses.pounding.histories import columns, contacts, histories, peaks
from stochlin.analyses.pounding.rows import (
    Building,
    build_row,
    checked_buildings,
    checked_gaps,
    checked_links,
)
from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.records.records import checked_record
from stochlin.analyses.records.response import pseudo_energy_radius
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import is_number
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.rows import Row
from stochlin.messages import brief
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.links import Link
from stochlin.models.parameters import Model

REFERENCES = (
    f"{labels.PAPER} Hairer, E., Norsett, S. P. and Wanner, G. (1993), Solving Ordinary Differential "
    "Equations I, section II.10."
)
STEP, STEPS_PER_PERIOD = 2.5e-6, 10.0  # [s] of a floor, and of the shortest period, roughly
ON_GRID = 1e-9  # of a step: times this close to a sample of the record are that


def pound(
    structures: Sequence[Building],
    gaps: npt.ArrayLike,
    contact: Contact,
    motion: xr.DataArray,
    *,
    link: Link | Sequence[Link | None] | None = None,
    output_step: float | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Buildings in a row through a motion, from rest, with all their impacts.

    Parameters
    ----------
    structures : list of Bilinear or BoucWen with a mass, and of ShearBuilding
        At least two, from left to right. Shear buildings, of these laws, meet at every floor of either
        up to the lower roof: floors within .05 m of one level slab to slab, any other a column of the
        neighbour, between two floors. An oscillator meets the roof of a shear building.
    gaps : list of float
        Between neighbours [m], not negative: 0 touches. For two structures a number will do.
    contact : Contact
        What all neighbours meet at, for instance `Kelvin` or `Stereomechanical`.
    motion : xarray.DataArray
        Ground acceleration [m/s^2] over ``time``, as `read_record` gives it; linear between samples.
    link : Link or list of Link and None, optional
        Springs and dashpots, linear, that yield or have slack. Without ``floors`` a link ties the
        highest at one level, without ``structures`` two neighbours: then there is one for each two, None
        where there is no link.
    output_step : float, optional
        Time from output to output [s]; the record's own if left out. The response does not depend on
        it.
    progress : callable, optional
        Called with the share of the two runs, in the row and alone, that is done.

    Returns
    -------
    xarray.Dataset
        Over ``time`` [s] and ``structure``, for shear buildings also ``floor``: ``displacement`` [m] and
        ``velocity`` [m/s], relative to the ground, absolute ``acceleration`` [m/s^2], and
        ``storey_shear`` [N] of the storey below the floor. Over ``time`` and ``contact``:
        ``contact_force`` [N]. Over ``time`` and ``structure``: ``base_shear`` [N], ``input_energy``,
        ``kinetic_energy``, ``elastic_energy``, ``viscous_energy``, ``hysteretic_energy`` [J]; over
        ``time``: ``contact_stored_energy`` and
        ``contact_lost_energy`` [J], and ``energy_balance_error`` [-], what is missing over the largest
        input energy so far. Over ``impact``: ``impact_time`` [s], ``impact_contact``,
        ``approach_velocity`` [m/s], ``largest_force`` [N] (NaN where velocities jump),
        ``impact_duration`` [s], ``energy_lost`` [J], and over ``side`` ``energy_transferred`` [J], the
        work on the structure there. ``peak`` and ``peak_alone`` [m], in the row and standing alone, and
        ``amplification`` [-], one over the other; likewise ``peak_acceleration``,
        ``peak_storey_shear`` and ``peak_base_shear``. Where all structures are
        `Bilinear` also ``largest_radius_amplification`` [-], the worst that `pounding_estimate` gives
        for a hit at the largest energy of both, without links. With links also, over ``time`` and
        ``link``, ``link_force`` [N], over ``time`` ``link_stored_energy`` and ``link_lost_energy`` [J],
        and ``peak_link_force`` [N].

        Coordinates of ``contact`` say which structures and floors meet, at which ``level`` [m], and of
        which ``kind`` they are. Where slabs meet columns also ``column``, the side whose column it is,
        its ``storey``, whose floor above stands for it, the ``share`` of that floor in the column's
        displacement, and ``column_force`` [N], the largest force on the columns of that storey, and
        ``column_force_share`` [-], that over the storey's shear at yield.

    Raises
    ------
    ValueError, TypeError
        If there are fewer than two structures, a law is another one, a mass is missing, velocities are
        to jump (`Stereomechanical`) where a slab meets a column, parameters are arrays, a link has no
        place, a gap is negative, the number of gaps or links is wrong, the output step is not
        positive, or the motion is not a record, has NaN or only zeros.
    ArithmeticError
        If a step cannot be completed, with the time and the state; or if a building falls over, as the
        weight above can make it (``p_delta``).

    Notes
    -----
    Displacements are positive to the right, where structure 2 stands beside structure 1. Steps of the
    8th order method of Dormand and Prince with an error of 1e-10 of the largest displacement, velocity
    and energy so far; they end at the samples of the record and wherever a structure yields or unloads,
    a contact begins, turns or ends. Peaks are those between outputs too: of displacements on the curve,
    of the others at the ends of steps, and in contact at eight places of each.

    An impact ends with its force. A `NoTensionKelvin` that pushes again before the floors are clear of
    it goes on with the same impact. In the law of `HertzDamp`, an approach slower than a thousandth of
    ``max |a| T/(2 pi)``, with the shortest period, counts as none: such a contact is elastic. Floors
    that a `Stereomechanical` impact would lift by less than 1e-10 of the largest displacement, while
    they are pressed together, move together from then on, until the force between them vanishes.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (13) to (16); Hairer, Norsett and Wanner (1993).

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(500)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> soft = sl.Bilinear(period=1.2, damping=0.05, mass=2e5)
    >>> stiff = sl.Bilinear(period=0.6, damping=0.05, mass=3e5)
    >>> bumper = sl.Kelvin(stiffness=1e8, restitution=0.65)
    >>> table = sl.pound([soft, stiff], gaps=0.05, contact=bumper, motion=record)
    >>> table.sizes["impact"], bool((table.approach_velocity > 0).all())
    (10, True)
    >>> bool(table.energy_balance_error.max() < 1e-6)
    True
    """
    row_of = checked_buildings(structures)
    spaces = checked_gaps(gaps, len(row_of))
    try:
        ground, dt = checked_record(motion)
    except (TypeError, ValueError) as error:
        raise type(error)(f"motion: {error}") from error
    links = checked_links(link, len(row_of))
    row, places = build_row(row_of, spaces, contact, ground, links)
    _check_work(row_of, dt * (ground.size - 1))
    times = _output_times(output_step, ground.size - 1, dt)
    asked = _intervals(times, dt, ground.size - 1)
    oscillators = [structure for structure in row_of if isinstance(structure, Bilinear)]
    estimated = len(oscillators) == len(row_of) and not any(links)
    if progress is not None:
        progress(0.0)
    never = np.empty(0, np.int64), np.empty(0)
    runs = (row, asked), (kernel.standing_alone(row), never)
    done, alone = in_order(
        lambda i: _completed(row_of, runs[i][0], kernel.SampledMotion(ground, dt, *runs[i][1])),
        2,
        progress,
    )
    worst = _estimates(oscillators, spaces, contact, motion) if estimated else None
    start = float(motion["time"][0])
    time = motion["time"].to_numpy().astype(float) if output_step is None else start + times
    table = histories(row, row_of, done, start, time)
    table = table.merge(contacts(places, links))
    table = table.assign(peaks(table, row, row_of, done, alone) | columns(table, row, places))
    table["amplification"] = table.peak / table.peak_alone.where(table.peak_alone > 0)
    if worst is not None:
        table["largest_radius_amplification"] = ("structure", worst)
    table = labels.label(table, VARIABLES)
    table.attrs.update(
        gaps=spaces.tolist(), steps=done.steps, motion=f"{ground.size} samples at {dt:g} s"
    )
    models: dict[str, Model] = {f"structure_{n}": each for n, each in enumerate(row_of, start=1)}
    models |= {f"link_{n}": each for n, each in enumerate(links, start=1) if each is not None}
    call = f"pound(output_step={output_step})"
    return labels.with_run_information(
        table, "Pounding of buildings in a row", call, models | {"contact": contact}, REFERENCES
    )


def _check_work(structures: Sequence[Building], seconds: float) -> None:
    """Raise a ValueError if steps for the shortest periods take too long; before the work."""
    modes = [
        structure.periods() if isinstance(structure, ShearBuilding) else structure.arrays()["period"]
        for structure in structures
    ]
    shortest = min(float(periods.min()) for periods in modes)
    check_work(
        f"{seconds:g} s of motion, with a shortest period of {shortest:.3g} s, would take",
        "take softer structures, or a shorter record",
        seconds=STEP * sum(periods.size for periods in modes) * STEPS_PER_PERIOD * seconds / shortest,
    )


def _output_times(output_step: float | None, intervals: int, dt: float) -> Array:
    if output_step is None:
        return dt * np.arange(intervals + 1)
    if not is_number(output_step):
        raise TypeError(
            f"output_step = {brief(output_step)} is not a number; allowed: seconds, positive"
        )
    if not 0 < output_step < np.inf:
        raise ValueError(
            f"output_step = {brief(output_step)} is out of range; allowed: 0 < value, finite"
        )
    return output_step * np.arange(int(intervals * dt / output_step * (1 + ON_GRID)) + 1)


def _intervals(times: Array, dt: float, intervals: int) -> tuple[Array, Array]:
    """Interval of the record and time since its beginning; samples are the ends of intervals."""
    scaled = times / dt
    whole = np.rint(scaled)
    scaled = np.where(np.abs(scaled - whole) < ON_GRID, whole, scaled)
    number = np.clip(np.ceil(scaled).astype(np.int64) - 1, 0, intervals - 1)
    share = np.clip(scaled - number, 0.0, 1.0)
    return number, share * dt


def _estimates(
    structures: Sequence[Bilinear], gaps: Array, contact: Contact, motion: xr.DataArray
) -> Array:
    """Largest amplification of each radius by a hit from either side, each pair at its own largest."""
    radii = [
        pseudo_energy_radius(
            motion,
            structure.period,
            structure.damping,
            hardening=structure.hardening,
            yield_displacement=structure.yield_displacement,
        ).pseudo_energy_radius
        for structure in structures
    ]
    worst = np.ones(len(structures))
    for b, gap in enumerate(gaps):
        first, second = structures[b : b + 2]
        hit = pounding_estimate(first, second, gap, contact, radii[b], radii[b + 1])
        for side in range(2):
            most = float(hit[f"largest_radius_amplification_{side + 1}"])
            worst[b + side] = max(worst[b + side], most)
    return worst


def _completed(structures: Sequence[Building], row: Row, motion: kernel.SampledMotion) -> kernel.Run:
    run = kernel.run(row, motion)
    _check_standing(structures, row, run)
    if run.completed:
        return run
    n = row.mass.size
    u, v = ([f"{value:.6g}" for value in run.last[part : part + n]] for part in (0, n))
    raise ArithmeticError(
        f"pound: the step from {run.time:.9g} s after the beginning could not be completed, after "
        f"{run.steps} steps; displacements of the floors [{', '.join(u)}] m, velocities "
        f"[{', '.join(v)}] m/s; use a softer or less damped contact, or a smaller restitution"
    )


def _check_standing(structures: Sequence[Building], row: Row, run: kernel.Run) -> None:
    """Raise an ArithmeticError if the weight has made a storey drift by more than its height."""
    for number, structure in enumerate(structures, start=1):
        if not isinstance(structure, ShearBuilding) or not structure.p_delta:
            continue
        u = run.last[row.first[number - 1] : row.first[number]]
        heights = structure.arrays()["heights"].to_numpy()
        excess = np.abs(np.diff(u, prepend=0.0)) / heights
        if excess.max() > 1:
            worst = int(np.argmax(excess))
            raise ArithmeticError(
                f"pound: structure {number} falls over: by {run.time:.4g} s after the beginning its "
                f"storey {worst + 1} has drifted by more than its height of {heights[worst]:g} m, for "
                "after yield the weight above takes more stiffness than it has; give it more hardening "
                "or strength, or a weaker motion"
            )
