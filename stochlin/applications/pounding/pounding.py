"""Pounding of buildings in a row: response histories in one motion, statistics over many."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.applications.pounding.results import (
    contacts,
    floor_coords,
    histories,
    labelled,
    summary,
)
from stochlin.applications.pounding.rows import (
    BetweenBuildings,
    PreparedRow,
    build_row,
    check_contact,
    checked_gaps,
    checked_links,
    checked_row,
    doubts_of_walls,
)
from stochlin.applications.pounding.runs import (
    STEPS_PER_CONTACT,
    failure,
    paces_of,
    responses,
    runs_of,
    starts_of,
)
from stochlin.applications.records.cells import RECORD, RecordedMotions, Records, checked_motions
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.pounding.run import RowResponse, StepCounts
from stochlin.messages import ImplausibleInput
from stochlin.models.arguments import Quantiles, Whole, checked
from stochlin.models.links import Link
from stochlin.models.parameters import Model
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.start import Start
from stochlin.models.structures import AnyStructure
from stochlin.models.walls import Wall
from stochlin.solver.simulation.results.peaks import LINK_PEAKS
from stochlin.solver.simulation.start_values import (
    END_STATE,
    AnyStart,
    as_end_state,
    check_arguments,
    start_in_words,
    with_arguments,
)
from stochlin.solver.simulation.statistics import (
    Columns,
    keeping_apart,
    mean_columns,
    pounding_shares,
    quantile_columns,
)
from stochlin.solver.simulation.structures_in_motion import PATH
from stochlin.solver.tables import labels

# dimensions that are dropped for one building alone
CONTACT_DIMENSIONS = "contact", "impact", "side", "neighbours"

# numbers of steps in half a period of a contact
FEWEST_STEPS_PER_CONTACT = 4
MOST_STEPS_PER_CONTACT = 4096

REFERENCES_OF_POUND = (
    f"{labels.PAPER} Newmark, N. M. (1959), J. Eng. Mech. Div. ASCE 85, for the time steps; "
    "Quispel, G. R. W. and McLaren, D. I. (2008), J. Phys. A 41, for mean forces over a step."
)
NEIGHBOURS = "neighbours"
# also of all contacts between two neighbours
BETWEEN_NEIGHBOURS = ("impacts", "hardest_force", "contact_energy")
RESPONSE_PEAKS = "peak", "peak_acceleration", "peak_storey_shear", "peak_base_shear"
# Variables with a mean and quantiles over several motions.
STATISTICS = (
    *BETWEEN_NEIGHBOURS,
    *(f"{name}_between" for name in BETWEEN_NEIGHBOURS),
    "fastest_approach",
    "column_force",
    "column_force_share",
    "amplification",
    *RESPONSE_PEAKS,
    *(f"{name}_alone" for name in RESPONSE_PEAKS),
    *LINK_PEAKS,
)


@checked
def pound(
    structures: Sequence[AnyStructure | Wall],
    gaps: npt.ArrayLike = (),
    contact: BetweenBuildings | None = None,
    motion: Records | None = None,
    *,
    link: Link | Sequence[Link | None] | None = None,
    start: AnyStart | None = None,
    quantiles: Quantiles = (0.5, 0.84, 0.95),
    steps_per_contact: Annotated[
        int, Whole(FEWEST_STEPS_PER_CONTACT, MOST_STEPS_PER_CONTACT)
    ] = STEPS_PER_CONTACT,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response of a row of buildings, with all impacts, in one motion or in many.

    For one motion the result has response histories, for several motions a summary of each motion,
    with means and quantiles. One building alone has no impacts; its displacements, forces and
    energies are computed in the same way.

    Parameters
    ----------
    structures : list of Bilinear, BoucWen or Hysteretic with a mass, of ShearBuilding, and of Wall
        Buildings from left to right, or one building, with any hysteresis law. They can meet at
        every floor of either building up to the lower roof: slab to slab where the floors are
        within 0.05 m of the same level, otherwise slab to column of the neighbour, between two of
        its floors. An oscillator meets the roof of a shear building. The first and the last may be
        a rigid `Wall`, which is not counted in the numbers of structures.
    gaps : list of float
        Gaps between neighbours [m], also to walls, not negative. For two structures one number is
        enough. One building alone has no gap.
    contact : Contact
        Contact between all neighbours, for instance `Kelvin` or `Stereomechanical`. It is not
        required for one building alone.
    motion : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time``, as from `read_record`, linear between samples.
        Several motions are an array also over ``path``, as from `simulated_motions`, or records as
        from `read_records`, which may differ in length and time step.
    link : Link or list of Link and None, optional
        Links between buildings and devices inside them, with springs that are linear or yield, and
        dashpots that are linear or have an exponent. Without ``floors`` a link ties the highest
        floors at the same level. Without ``structures`` a list has one link for each two
        neighbours, or None. A link that names one structure twice is a device inside it and also
        acts in the response of this building alone.
    start : Start or xarray.DataArray, optional
        Displacements and velocities at the start, from rest by default; or the ``end_state`` of the
        result for a motion before, of the same arguments, which then goes on.
    quantiles : sequence of float
        Probabilities, between 0 and 1, of the quantiles over several motions.
    steps_per_contact : int
        Number of time steps in half a period of the contact, from 4 to 4096; see Notes. All time
        steps are shorter the larger it is, and the error falls with its square.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        For one motion, histories over ``time`` [s] and ``structure``, for shear buildings also
        ``floor``: ``displacement`` [m] and ``velocity`` [m/s] relative to the ground, absolute
        ``acceleration`` [m/s^2], and ``storey_shear`` [N] of the storey below the floor. Over
        ``time`` and ``structure``: ``base_shear`` [N], ``input_energy``, ``kinetic_energy``,
        ``elastic_energy``, ``viscous_energy`` and ``hysteretic_energy`` [J]. Over ``time`` and
        ``contact``: ``contact_force`` [N]. Over ``time``: ``contact_stored_energy`` and
        ``contact_lost_energy`` [J], and ``energy_balance_error`` [-], the energy that the time
        steps did not account for over the largest input energy so far. With links also
        ``link_force`` [N] over ``time`` and ``link``, and ``link_stored_energy`` and
        ``link_lost_energy`` [J] over ``time``. With walls fixed in space also ``wall_displacement``
        [m], relative to the ground, and ``wall_energy`` [J], their work on the buildings.

        Over ``impact``: ``impact_time`` [s], ``impact_contact``, ``approach_velocity`` [m/s],
        ``largest_force`` [N] (NaN for a `Stereomechanical` contact), ``impact_duration`` [s] and
        ``energy_lost`` [J]; also over ``side``, ``energy_transferred`` [J], the work of the impact
        on the structure on this side.

        Peaks over ``structure`` and for shear buildings ``floor``: ``peak`` [m] in the row and
        ``peak_alone`` [m] of each building alone, and ``amplification`` [-], their ratio;
        ``peak_acceleration`` [m/s^2], ``peak_storey_shear`` [N] and ``peak_base_shear`` [N], each
        also with the ending ``_alone``. With links also, over ``link``, ``peak_link_force`` [N],
        ``peak_link_stroke`` [m], the largest absolute extension, and ``link_energy`` [J], which the
        link dissipates.

        For one motion ``end_state`` over ``state``, from which ``start`` goes on, with a motion
        that begins with the last sample of the one before. Histories, energies and peaks of the
        second are then those of one motion of both, with the same bits; its impacts begin with one
        that was going on.

        For one motion ``step_error`` [-]: the largest relative change from steps twice as long of a
        peak displacement, drift, storey shear or acceleration, or of the largest force of a
        contact. About a third of it remains. Histories are sampled at the times of the record:
        their largest values are below the peaks of the summary.

        Over ``contact``: ``gap`` [m], the number of ``impacts``, ``hardest_force`` [N],
        ``fastest_approach`` [m/s], ``longest_impact`` [s] and ``deepest_compression`` [m], all 0
        without an impact; ``hardest_force`` and ``deepest_compression`` are NaN for a
        `Stereomechanical` contact. Also ``contact_energy`` [J], the energy lost in the contact.
        Over ``structure``: ``energy_received`` [J] from all impacts.

        Coordinates of ``contact`` are the structures and floors that meet, 0 for a wall, the
        ``level`` [m] and the ``kind``, for instance slab to column. If a column is met, there are
        also the coordinates ``column``, the side of the column, ``storey``, that of the column, and
        ``share``, by which the displacement of the floor above counts in that of the column; and
        the variables ``column_force`` [N], the largest force on the columns of this storey, and
        ``column_force_share`` [-], this force over the shear of the storey at yield. With walls
        there is the coordinate ``wall``, ground or space.

        Over ``neighbours``, for all contacts across a gap together: ``impacts_between``,
        ``hardest_force_between`` [N] and ``contact_energy_between`` [J].

        For several motions there are no histories. The peaks, the variables over ``contact``,
        ``energy_received`` and the largest ``energy_balance_error`` are then also over ``path`` or
        ``record``. ``status`` and ``missing`` mark motions that failed, whose results are NaN;
        ``missing`` gives the reason. From the other motions follow names ending in ``_mean`` and
        ``_mean_standard_error``, and in ``_quantile`` over ``quantile`` with its 95 % interval
        ``_lower`` and ``_upper`` (infinite where the motions are too few), for all these variables
        except ``longest_impact``, ``deepest_compression`` and ``energy_received``.
        ``pounding_probability`` and ``no_pounding_probability`` [-] over ``neighbours`` are the
        shares of motions with and without an impact, with their 95 % intervals.

        For one building alone there is nothing over ``contact``, ``impact`` and ``neighbours``.

    Raises
    ------
    ValueError, TypeError
        If there is no structure, or a structure has an array as parameter or no mass; if a wall is
        not at an end of the row, or has levels above the roof; if the contact is missing for
        several structures, or is `Stereomechanical` where a column is met; if a gap is negative, or
        the number of gaps or links is wrong; if a link names a floor or structure that does not
        exist; if the output step is not positive or is given with several motions; if there is no
        motion, or a motion is not a record, has NaN, or from rest only zeros; if the start has
        another number of values, yields or overlaps, or is of a motion of other arguments; or if
        the computation would take too long.
    ArithmeticError
        If the response is no longer finite, since a law runs away. Also if a structure with a
        negative stiffness after yielding falls, as in `simulate`. With several motions the results
        of such a motion are NaN; only if all motions fail, the error of the first is raised.

    Warns
    -----
    ImplausibleInput
        If a gap is above 0.9 m; if a contact is pressed together by more than 2 cm, as if its
        stiffness were in another unit; or if a wall fixed in space moves by more than 2 m against
        the ground, or comes closer to the other wall than the gaps allow.

    Notes
    -----
    Each of several motions gives exactly the results that it gives alone. A motion that fails, for
    instance because a building collapses, is a severe one. Quantiles over the other motions are
    therefore too small.

    Displacements are positive to the right; structure 2 stands to the right of structure 1. The
    time steps are those of the trapezoidal rule, which is of second order, with contacts as
    elements that only push. There are at least ``12.5 steps_per_contact`` steps in the shortest of
    the first periods and ``5 steps_per_contact`` in the shortest period of a mode with 1 % of the
    mass. While a contact is closed, or may become so, they are divided further, so that
    ``steps_per_contact`` of them are in half a period of every contact with the reduced mass of its
    floors; for a Hertz element it is that of an approach at 1 m/s. A contact force is the mean over
    the step, in which the penetration grows evenly. Outputs that are not at the end of a step are
    interpolated linearly.

    Peaks are taken from every time step. Those of displacements include those within steps, and the
    largest force of an impact is that of a parabola through forces at the ends of steps. Peaks of
    storey shears, of accelerations and of forces of links are those at the ends of steps, of
    accelerations also where a bilinear element begins to yield within a step. By default peaks of
    elastic structures are within 0.1 %, of yielding ones within 0.3 %, and accelerations in impacts
    within 0.2 % in nine of ten cases. Accelerations are up to 1 % too low, which ``step_error``
    may not show, with `ModifiedClough` and `Flag`, whose branches have corners too.

    An impact ends when the gap opens again; its duration is until the contact force has vanished.
    If a `NoTensionKelvin` pushes again before the gap has opened, this continues the same impact.
    For `HertzDamp`, an approach velocity below a thousandth of ``max |a| T/(2 pi)``, with the
    largest ground acceleration ``|a|`` and the shortest first period ``T``, counts as zero, and the
    contact is then elastic. A `Stereomechanical` impact takes place at the time of touch within a
    step. If the floors are pressed together so much that the rebound would take less than two
    steps, they move together, as one impact, until they are pulled apart; smaller rebounds are not
    counted.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (13) to (16); Newmark, N. M. (1959), J. Eng. Mech. Div.
    ASCE 85, with average acceleration, for the time steps; Quispel, G. R. W. and McLaren, D. I.
    (2008), J. Phys. A 41, for mean forces over a step, which conserve energy; Clopper and Pearson
    (1934), Biometrika 26, for the intervals of probabilities.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(500)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> soft = sl.Bilinear(period=1.2, damping=0.05, mass=2e5)
    >>> stiff = sl.Bilinear(period=0.6, damping=0.05, mass=3e5)
    >>> bumper = sl.Kelvin(stiffness=1e9, restitution=0.65)
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
    neighbours = checked_row(structures)
    buildings = neighbours.buildings
    spaces = checked_gaps(gaps, neighbours.gaps)
    if spaces.size:
        check_contact("contact", contact)
    levels = np.asarray(quantiles, float)
    motions, over, names = checked_ensemble(motion, may_be_still=start is not None)
    links = checked_links(link, len(buildings))
    models = labels.named_models(buildings, links=links)
    if spaces.size:
        models |= {f"wall_{side}": wall for side, wall in neighbours.walls.items()}
        models["contact"] = contact
    arguments = described_arguments(models, spaces)
    check_arguments(start, arguments)
    prepared = build_row(neighbours, spaces, contact, links)
    velocity = start.ground_velocity if isinstance(start, Start) else 0.0
    for text in doubts_of_walls(neighbours, spaces, motions.grounds, velocity):
        warnings.warn(f"pound: {text}", ImplausibleInput, stacklevel=3)
    paces = paces_of(prepared, contact, motions.grounds, steps_per_contact)
    if progress is not None:
        progress(0.0)
    starts = starts_of(prepared, start)
    table = response_table(prepared, motions, over, paces, starts, progress)
    table = table.merge(contacts(prepared.places, links))
    table = table.assign(gap=("contact", prepared.row.contacts.gap))
    if not spaces.size:
        table = table.drop_dims(CONTACT_DIMENSIONS, errors="ignore")
    else:
        table = table.merge(between_neighbours(table))
        # Impacts without a compression are NaN, which the maximum leaves out.
        deepest = float(table["deepest_compression"].max())
        if text := PLAUSIBLE["penetration"].doubt(deepest):
            what = f"pound: a contact is pressed together by {deepest:.3g} m"
            warnings.warn(f"{what}; {text}", ImplausibleInput, stacklevel=3)
    call = f"steps_per_contact={steps_per_contact}"
    described = motions.describe()
    if motions.names is not None:
        table = with_statistics(table, over, levels)
        call = f"quantiles={levels.tolist()}, {call}"
        if names is not None:
            about = "record" if over == RECORD else "simulated motion"
            table = table.assign_coords({over: names.assign_attrs(long_name=about)})
        if over == PATH:
            described = f"{len(motions.grounds)} simulated motions"
    table = labels.label(table).assign_attrs(motion=described.removeprefix("record: "))
    title = "A building alone in a motion"
    if spaces.size:
        title = "Pounding of buildings in a row"
        table = table.assign_attrs(gaps=spaces.tolist())
    table = with_arguments(table.assign_attrs(start_in_words(start)), arguments)
    return labels.with_run_information(table, title, f"pound({call})", models, REFERENCES_OF_POUND)


def described_arguments(models: Mapping[str, Model], gaps: Array) -> dict[str, str]:
    """The arguments of a motion in words, which must be those of a motion that goes on from it."""
    described = {"function": "pound"} | {role: model.describe() for role, model in models.items()}
    return described | ({"gaps": ", ".join(f"{gap:g} m" for gap in gaps)} if gaps.size else {})


def checked_ensemble(
    motion: Any, may_be_still: bool
) -> tuple[RecordedMotions, str, xr.DataArray | None]:
    """One motion or several, checked, their dimension, and the coordinate along it if there is one.

    An array over ``path`` and ``time`` has one motion a path. One motion has no names, and adds no
    dimension to results.
    """
    try:
        if not isinstance(motion, xr.DataArray):
            motions = checked_motions(motion, may_be_still)
            return motions, RECORD, xr.DataArray(motions.names, dims=RECORD)
        if PATH not in motion.dims:
            return checked_motions(motion, may_be_still), PATH, None
        paths = {f"path {n}": motion.isel({PATH: n}, drop=True) for n in range(motion.sizes[PATH])}
        coordinate = motion[PATH] if PATH in motion.coords else None
        return checked_motions(paths, may_be_still), PATH, coordinate
    except (TypeError, ValueError) as error:
        raise type(error)(f"motion: {error}") from error


def response_table(
    prepared: PreparedRow,
    motions: RecordedMotions,
    over: str,
    paces: Sequence[StepCounts],
    starts: Sequence[Array | None],
    progress: Progress | None,
) -> xr.Dataset:
    """Summary of each motion, or summary and histories of a single one.

    The results of one of several motions that fails are NaN, with the reason in ``missing``.
    """
    single = motions.names is None
    size = 3 if single else 2  # number of responses to each motion, see `runs_of`
    runs = [
        run
        for ground, pace in zip(motions.grounds, paces, strict=True)
        for run in runs_of(prepared, ground, pace, starts)[:size]
    ]
    outcomes = responses(runs, prepared, single, progress)
    by_motion = [outcomes[begin : begin + size] for begin in range(0, len(outcomes), size)]
    reasons = [_reason(prepared, several) for several in by_motion]
    if all(reasons):
        more = f"; so in all {len(reasons)} motions" if reasons[1:] else ""
        raise ArithmeticError(f"{reasons[0]}{more}")
    with np.errstate(invalid="ignore", over="ignore"):  # motions that failed
        rows = [summary(prepared, *several) for several in by_motion]
    columns = {
        name: (dim, np.array([row[name][1] for row in rows], float))
        for name, (dim, _) in rows[0].items()
    }
    table = xr.Dataset(labelled(columns, prepared, over), coords=floor_coords(prepared))
    if single:
        [ground] = motions.grounds
        courses = histories(prepared, outcomes[0], ground, motions.records[0]["time"])
        courses = courses.assign(table.isel({over: 0}).drop_vars("energy_balance_error").data_vars)
        seconds = ground.dt * (ground.acceleration.size - 1)
        ends = [response.end_after(seconds) for response in outcomes]
        return courses.assign({END_STATE: as_end_state(np.concatenate(ends))})
    good = xr.DataArray([not reason for reason in reasons], dims=over)
    table = table.where(good)
    table["status"] = labels.status_where(good, labels.NOT_CONVERGED)
    about = {"long_name": "missing results of a motion, and the reason"}
    return table.assign_coords(missing=(over, reasons, about))


def _reason(prepared: PreparedRow, several: Sequence[RowResponse]) -> str:
    """Why a response to a motion failed; empty if none of them failed."""
    reasons = (failure(prepared, response) for response in several)
    return next(filter(None, reasons), "")


def with_statistics(table: xr.Dataset, over: str, levels: Array) -> xr.Dataset:
    """The table with values for each gap, and with means and quantiles over the motions.

    Motions that failed do not count.
    """
    good = table.isel({over: (table.status == labels.CONVERGED).values})
    columns: Columns = {}
    for name in (name for name in STATISTICS if name in good):
        samples = good[name].transpose(over, ...)
        defined = samples.notnull().values.all(axis=0)  # elsewhere statistics are NaN
        dims = samples.dims[1:]
        values = np.where(defined, samples.values, 0.0)
        statistics = mean_columns(name, dims, values)
        statistics |= quantile_columns(name, dims, values, levels)
        for column, (over_dims, numbers) in statistics.items():
            columns[column] = over_dims, np.where(defined, numbers, np.nan)
    # Added at once, because each addition to a dataset takes a millisecond.
    axis = labels.axis("quantile", "quantile", levels)
    table = table.assign(columns).assign_coords(quantile=axis)
    if NEIGHBOURS not in table.dims:
        return table
    hits = good.impacts_between.rename({over: PATH})
    shares = {f"pounding_{name}": share for name, share in pounding_shares(hits, 0.0).items()}
    return table.assign(shares | keeping_apart(hits, 0.0))


def between_neighbours(table: xr.Dataset) -> xr.Dataset:
    """The variables of `BETWEEN_NEIGHBOURS`, of all contacts between two neighbours together."""
    by_gap = table[[*BETWEEN_NEIGHBOURS]].groupby("left")
    joined = by_gap.sum(skipna=False).assign(hardest_force=by_gap.max(skipna=False).hardest_force)
    right_of = dict(zip(table.left.values, table.right.values, strict=True))
    names = [f"{left or 'wall'} | {right_of[left] or 'wall'}" for left in joined.left.values]
    new_names = {name: f"{name}_between" for name in BETWEEN_NEIGHBOURS}
    joined = joined.rename(new_names | {"left": NEIGHBOURS})
    coordinate = NEIGHBOURS, names, {"long_name": "both sides of the gap"}
    return joined.assign_coords({NEIGHBOURS: coordinate}).transpose(..., NEIGHBOURS)
