"""Buildings in a row that pound against each other: histories in one motion, statistics of many."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.pounding.ensembles import checked_ensemble, over_motions, with_statistics
from stochlin.analyses.pounding.estimates import pounding_estimate_row
from stochlin.analyses.pounding.histories import contacts, course, histories
from stochlin.analyses.pounding.rows import (
    Building,
    Meeting,
    build_row,
    check_contact,
    checked_buildings,
    checked_gaps,
    checked_links,
)
from stochlin.analyses.pounding.runs import ON_GRID, alone, check_runs, in_row
from stochlin.analyses.pounding.summaries import labelled, summary
from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.records.cells import Records
from stochlin.analyses.records.response import pseudo_energy_radius
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import checked_quantiles, is_number
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.pounding.rows import Row
from stochlin.kernels.records.runs import SampledGround
from stochlin.messages import brief
from stochlin.models.contacts import Contact
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.links import Link
from stochlin.models.parameters import Model

OF_CONTACTS = "contact", "impact", "side", "neighbours"  # dimensions that one building alone has not

REFERENCES = (
    f"{labels.PAPER} Hairer, E., Norsett, S. P. and Wanner, G. (1993), Solving Ordinary Differential "
    "Equations I, section II.10."
)


def pound(
    structures: Sequence[Building],
    gaps: npt.ArrayLike = (),
    contact: Contact | None = None,
    motion: Records | None = None,
    *,
    link: Link | Sequence[Link | None] | None = None,
    output_step: float | None = None,
    quantiles: Sequence[float] = (0.5, 0.84, 0.95),
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response of a row of buildings with all impacts, in one motion or many, from rest.

    Of one motion there are histories, of several what each comes to, with means and quantiles. One
    building alone has no impacts, and all the rest: what it bears, and where its energy goes.

    Parameters
    ----------
    structures : list of Bilinear or BoucWen with a mass, and of ShearBuilding
        From left to right, or one alone. Shear buildings, of these laws, meet at every floor of either
        up to the lower roof: floors within 0.05 m of one level slab to slab, any other a column of the
        neighbour, between two floors. An oscillator meets the roof of a shear building.
    gaps : list of float
        Between neighbours [m], not negative: 0 touches. For two structures a number will do; one alone
        has none.
    contact : Contact
        What all neighbours meet at, for instance `Kelvin` or `Stereomechanical`; of one building alone
        it is left out.
    motion : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time``, as `read_record` gives it; linear between samples.
        Several: over ``path``, too, as `simulated_motions` gives them, or records, as `read_records`
        does. Those need not be of one length or step.
    link : Link or list of Link and None, optional
        Springs, linear, that yield or have slack, and dashpots, linear or with an exponent. Without
        ``floors`` a link ties the highest at one level, without ``structures`` two neighbours: then
        there is one for each two, None where there is no link. With one structure twice it is a device
        inside it, which it keeps standing alone.
    output_step : float, optional
        Time from output to output [s] of one motion; the record's own if left out. The response does
        not depend on it.
    quantiles : sequence of float
        Of what several motions come to, between 0 and 1.
    progress : callable, optional
        Called with the share that is done of the motions; of one, of its two runs, in the row and alone.

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
        ``amplification`` [-], one over the other; likewise ``peak_acceleration`` [m/s^2],
        ``peak_storey_shear`` [N] and ``peak_base_shear`` [N], each also ``_alone``. Over ``contact``:
        ``gap`` [m], the number of ``impacts``, ``hardest_force`` [N], ``fastest_approach`` [m/s],
        ``longest_impact`` [s], ``deepest_compression`` [m] (these four NaN without an impact, the last
        where velocities jump, too) and ``contact_energy`` [J] that it has taken; over ``structure``
        ``energy_received`` [J] from all impacts. Where all structures are `Bilinear` also
        ``largest_radius_amplification`` [-], the worst that `pounding_estimate` gives
        for a hit at the largest energy of both, without links. With links also, over ``time`` and
        ``link``, ``link_force`` [N], over ``time`` ``link_stored_energy`` and ``link_lost_energy`` [J],
        and ``peak_link_force`` [N].

        Of one building alone there is nothing over ``contact``, ``impact`` and ``neighbours``.

        Coordinates of ``contact`` say which structures and floors meet, at which ``level`` [m], and of
        which ``kind`` they are. Where slabs meet columns also ``column``, the side whose column it is,
        its ``storey``, whose floor above stands for it, the ``share`` of that floor in the column's
        displacement, and ``column_force`` [N], the largest force on the columns of that storey, and
        ``column_force_share`` [-], that over the storey's shear at yield.

        Of several motions no histories, and of the rest, over ``path`` or ``record``, too: peaks, those
        ``_alone``, ``amplification``, what there is over ``contact``, ``energy_received`` and the
        largest ``energy_balance_error``; over ``neighbours``, for all contacts of a gap together,
        ``impacts_between``, ``hardest_force_between`` [N] and ``contact_energy_between`` [J];
        ``status``, and ``missing``, which says what has gone wrong in a motion that is NaN. Over all
        motions that are not: ``_mean`` with ``_mean_standard_error``, and ``_quantile`` over
        ``quantile`` with its 95 % interval, ``_lower`` and ``_upper`` (infinite where the motions are
        too few to bound it), of all that but ``longest_impact``, ``deepest_compression`` and energies
        received, where a motion without an impact counts with a force and an approach of 0;
        ``pounding_probability`` and
        ``no_pounding_probability`` [-] over ``neighbours``, the shares of motions with an impact and
        without, with their 95 % intervals.

    Raises
    ------
    ValueError, TypeError
        If there is no structure, a law is another one, a mass, a motion or, of several structures, the
        contact is missing, velocities are to jump (`Stereomechanical`) where a slab meets a column,
        parameters are arrays, a link has no place, a gap is negative, the number of gaps or links is
        wrong, the output step is not positive or given with several motions, a motion is not a record,
        has NaN or only zeros, there is none, or they would take too long.
    ArithmeticError
        If a step cannot be completed, with the time and the state; or if a building falls over, as the
        weight above can make it (``p_delta``). Of several motions that one is NaN; if all fail, the
        first says why.

    Notes
    -----
    Of several motions each is what it is alone, to the bit. One that fails, as where a building falls
    over, is no mild one: where some are missing, the quantiles of the others are too small.

    Displacements are positive to the right, where structure 2 stands beside structure 1. Steps of the
    8th order method of Dormand and Prince with an error of 1e-10 of the largest displacement, velocity
    and energy so far; they end at the samples of the record and wherever a structure yields or unloads,
    a contact begins, turns or ends. Peaks are those between outputs too: of displacements on the curve,
    of the others at the ends of steps, and in contact at eight places of each.

    An impact ends when the contact force vanishes. A `NoTensionKelvin` that pushes again before the
    floors are clear of it goes on with the same impact. In the law of `HertzDamp`, an approach slower
    than a thousandth of ``max |a| T/(2 pi)``, with the shortest period, counts as none: such a contact
    is elastic. Floors that a `Stereomechanical` impact would lift by less than 1e-10 of the largest
    displacement, while they are pressed together, move together from then on, until the force between
    them vanishes.

    A dashpot with an exponent is linear below a millionth of the velocity that the motion can give the
    structures, or, where it would bring its masses to rest in less than 5e-5 s, below a rate at which it
    does not: so strong a one with a small exponent creeps somewhat faster.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (13) to (16); Hairer, Norsett and Wanner (1993); Clopper and
    Pearson (1934), Biometrika 26, for the intervals of shares.

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
    >>> alone = sl.pound([soft], motion=record)
    >>> float(alone.amplification[0]), "impact" in alone.dims
    (1.0, False)
    >>> motions = sl.simulated_motions(sl.named_ground("firm", intensity=0.01), 5.0, paths=16)
    >>> many = sl.pound([soft, stiff], gaps=0.1, contact=bumper, motion=motions)
    >>> many.impacts.dims, float(many.pounding_probability[0])
    (('path', 'contact'), 0.3125)
    """
    row_of = checked_buildings(structures)
    spaces = checked_gaps(gaps, len(row_of))
    check_contact(contact, len(row_of))
    levels = checked_quantiles(quantiles)
    if motion is None:
        raise TypeError("motion is not given; allowed: a record or several, as read_record gives them")
    try:
        ensemble = checked_ensemble(motion)
    except (TypeError, ValueError) as error:
        raise type(error)(f"motion: {error}") from error
    links = checked_links(link, len(row_of))
    motions, over, _ = ensemble
    row, places = build_row(row_of, spaces, contact, motions.grounds[0].acceleration, links)
    check_runs(row_of, row, motions.grounds)
    if over is not None and output_step is not None:
        raise ValueError(
            f"output_step = {brief(output_step)} is for one motion; allowed here: none, since "
            "histories of several motions are not kept"
        )
    if progress is not None:
        progress(0.0)
    lines = contacts(places, links)
    if over is None:
        assert isinstance(motion, xr.DataArray)
        ground = motions.grounds[0]
        times = _output_times(output_step, ground)
        table = _of_one(row_of, row, places, ground, motion["time"], times, progress).merge(lines)
        oscillators = [structure for structure in row_of if isinstance(structure, Bilinear)]
        if contact is not None and len(oscillators) == len(row_of) and not any(links):
            worst = _estimates(oscillators, spaces, contact, motion)
            table["largest_radius_amplification"] = ("structure", worst)
        call = f"pound(output_step={output_step})"
    else:
        table = over_motions(row_of, row, places, ensemble, progress).merge(lines)
        table = with_statistics(table, over, levels)
        call = f"pound(quantiles={levels.tolist()})"
    table["gap"] = ("contact", row.gap)
    table = labels.label(table, VARIABLES).assign_attrs(motion=ensemble.describe())
    models: dict[str, Model] = {f"structure_{n}": each for n, each in enumerate(row_of, start=1)}
    models |= {f"link_{n}": each for n, each in enumerate(links, start=1) if each is not None}
    title = "Pounding of buildings in a row"
    if contact is None or not spaces.size:
        title = "A building alone in a motion"
        table = table.drop_dims(OF_CONTACTS, errors="ignore")
    else:
        models["contact"] = contact
        table = table.assign_attrs(gaps=spaces.tolist())
    return labels.with_run_information(table, title, call, models, REFERENCES)


def _of_one(
    structures: Sequence[Building],
    row: Row,
    places: Sequence[Meeting],
    ground: SampledGround,
    time: xr.DataArray,
    times: Array | None,
    progress: Progress | None,
) -> xr.Dataset:
    """Histories of one motion, and what it comes to."""
    runs = (lambda: in_row(structures, row, ground, times)), (lambda: alone(structures, row, ground))
    done, lone = in_order(lambda i: runs[i](), len(runs), progress)
    start, found = float(time[0]), course(row, done)
    at = time.to_numpy().astype(float) if times is None else start + times
    table = histories(found, row, structures, done, start, at)
    values = summary(row, places, found, done, lone)
    return table.assign(labelled(values, row, structures)).assign_attrs(steps=done.steps)


def _output_times(output_step: float | None, ground: SampledGround) -> Array | None:
    """Times since the beginning [s]; None for the samples of the motion."""
    if output_step is None:
        return None
    if not is_number(output_step):
        raise TypeError(
            f"output_step = {brief(output_step)} is not a number; allowed: seconds, positive"
        )
    if not 0 < output_step < np.inf:
        raise ValueError(
            f"output_step = {brief(output_step)} is out of range; allowed: 0 < value, finite"
        )
    length = (len(ground.acceleration) - 1) * ground.dt
    return output_step * np.arange(int(length / output_step * (1 + ON_GRID)) + 1)


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
    worst = pounding_estimate_row(structures, gaps, contact, radii).largest_radius_amplification
    return worst.to_numpy()
