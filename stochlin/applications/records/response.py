"""Response of structures to records: response spectra, pseudo energy radius, response histories."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import (
    ONE_STRUCTURE,
    OnRecord,
    RecordCells,
    RecordedMotions,
    Records,
    checked_motions,
)
from stochlin.applications.records.stepped import stepped_history
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.records import oscillator as recorded
from stochlin.kernels.records.oscillator import INPUT_ENERGY
from stochlin.kernels.records.oscillator import STATE as STATE_SIZE
from stochlin.kernels.records.runs import peaks_on_records, response
from stochlin.models.arguments import Whole, checked
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Parameter
from stochlin.models.start import Start
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import assembly_of
from stochlin.solver.simulation.start_values import (
    END_STATE,
    AnyStart,
    as_end_state,
    check_arguments,
    checked_end_state,
    start_in_words,
    start_values,
    with_arguments,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

_KINDS = ("input", "viscous", "hysteretic", "kinetic", "elastic")
ENERGIES_PER_MASS = tuple(f"{kind}_energy_per_mass" for kind in _KINDS)
RESPONSE_REFERENCES = (
    f"{labels.PAPER} Nigam, N. C. and Jennings, P. C. (1969). Calculation of response spectra from "
    "strong-motion earthquake records. Bull. Seismol. Soc. Am. 59."
)


@checked
def pseudo_energy_radius(
    record: Records,
    period: Parameter,
    damping: Parameter,
    *,
    hardening: Parameter | None = None,
    yield_displacement: Parameter | None = None,
) -> xr.Dataset:
    """Pseudo energy radius of structures on records, eqs. (1) and (2).

    ``r_PER = max sqrt(u^2 + (u'/w)^2)``, with ``w = 2 pi/T`` of the elastic structure. It is at
    least ``max |u|``, and equal to it only if the velocity is zero at the largest energy.

    Parameters
    ----------
    record, period, damping, hardening, yield_displacement
        As in `response_spectrum`, whose result includes that of this function.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``pseudo_energy_radius`` [m]; ``displacement_max``
        [m], which is ``max |u|``; ``status``, which is ``elastic_limit`` where the structure did
        not yield.

    Raises
    ------
    ValueError, TypeError
        As in `response_spectrum`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (2), Fig. 1.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> table = sl.pseudo_energy_radius(record, period=[0.2, 1.0], damping=0.05)
    >>> bool((table.pseudo_energy_radius >= table.displacement_max).all())
    True
    """
    strength: Any = {"hardening": hardening, "yield_displacement": yield_displacement}
    spectrum = response_spectrum(record, period, damping, **strength)
    table = spectrum[["pseudo_energy_radius", "displacement_max", "status"]]
    title = "Pseudo energy radius"
    return labels.with_run_information(
        table, title, "pseudo_energy_radius()", {}, RESPONSE_REFERENCES
    )


@checked
def response_spectrum(
    record: Records,
    period: Parameter,
    damping: Parameter,
    *,
    hardening: Parameter | None = None,
    yield_displacement: Parameter | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Response spectra of records: peak responses of elastic or bilinear oscillators.

    Parameters
    ----------
    record : xarray.DataArray, or list or mapping of them
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`. Several records add
        the dimension ``record`` to the result.
    period, damping : float or array
        Period ``T`` [s], at least a tenth of the time step of the record, and damping ratio [-], in
        (0, 1).
    hardening : float or array, optional
        Hardening ratio, post-yield over elastic stiffness [-], in (0, 1]. It is required with a
        yield displacement.
    yield_displacement : float or array, optional
        Yield displacement ``uy`` [m], positive. By default the structure stays elastic.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``displacement_max`` [m] and ``velocity_max`` [m/s],
        relative to the ground; ``acceleration_max`` [m/s^2], absolute; ``pseudo_velocity`` [m/s],
        ``w max |u|``, and ``pseudo_acceleration`` [m/s^2], ``w^2 max |u|``, with ``w = 2 pi/T``;
        ``pseudo_energy_radius`` [m]; ``input_energy_per_mass``, ``viscous_energy_per_mass`` and
        ``hysteretic_energy_per_mass`` [m^2/s^2] at the end of the record, as in `respond`; and
        ``status``, which is ``elastic_limit`` where the structure did not yield. With a yield
        displacement also ``permanent_set`` [m], the displacement at which the structure comes to
        rest if it does not yield after the end of the record.

    Raises
    ------
    ValueError, TypeError
        If a record is not valid, a scalar is out of range, a period is too short, or dimensions do
        not match. Other cells of an array that are out of range are NaN, with the status
        ``invalid_input``. If the table would need too much memory or time.
    ArithmeticError
        If the response is not a number, since its squares are beyond the range of numbers. In a
        table such cells are NaN, with the status ``not_converged``.

    Notes
    -----
    The ground acceleration is linear between samples, and for it the response is exact: each linear
    branch has its closed-form solution, and yielding and unloading are located within a time step.
    Peaks between steps are those of cubic interpolation, with an error of a few 1e-4. Peaks after
    the end of the record are not found; append zeros to a record that ends while structures still
    move.

    References
    ----------
    Nigam and Jennings (1969), Bull. Seismol. Soc. Am. 59, for the exact transition.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(1000)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> table = sl.response_spectrum(record, period=[0.2, 1.0, 5.0], damping=0.05)
    >>> int(table.displacement_max.argmax("case"))
    1
    >>> yields = sl.response_spectrum(record, 1.0, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> float(yields.acceleration_max) < float(table.acceleration_max[1])
    True
    """
    structure = Bilinear(period, damping, hardening, yield_displacement)
    motions = checked_motions(record)
    cells = RecordCells.of(motions, structure)
    [parameters] = cells.sides
    peaks = peaks_on_records(motions.grounds, parameters, progress=progress)[:, :, 0]
    w = parameters[:, 0]
    displacement = cells.peak(0, peaks)
    states = peaks[..., recorded.PEAKS :]
    columns = {
        "displacement_max": displacement,
        "velocity_max": peaks[..., recorded.VELOCITY],
        "acceleration_max": peaks[..., recorded.ACCELERATION],
        "pseudo_velocity": w * displacement,
        "pseudo_acceleration": w**2 * displacement,
        "pseudo_energy_radius": peaks[..., recorded.RADIUS],
        **dict(zip(ENERGIES_PER_MASS[:3], _energies(parameters, states), strict=False)),
    }
    if structure.yields:
        # At rest alpha u + (1 - alpha) y = 0, while u - y stays as it is.
        columns["permanent_set"] = (1 - parameters[:, 2]) * (states[..., 0] - states[..., 2])
    stands = np.isfinite(displacement)
    columns = {name: np.where(stands, values, np.nan) for name, values in columns.items()}
    table = cells.table({**columns, "displacement_max": displacement}, [displacement])
    return _with_information(table, "Response spectrum", "response_spectrum()", structure, motions)


@checked
def respond(
    structure: OnRecord,
    record: xr.DataArray,
    *,
    refine: Annotated[int, Whole(1)] = 1,
    start: AnyStart | None = None,
) -> xr.Dataset:
    """Response history of one structure to a record.

    Parameters
    ----------
    structure : Bilinear, BoucWen, Hysteretic or ShearBuilding
        Structure with scalar parameters, elastic or with a yield displacement or yield drifts.
    record : xarray.DataArray
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`, linear between
        samples.
    refine : int
        Number of output times in each interval of the record. The response at the times of the
        record does not depend on it.
    start : Start or xarray.DataArray, optional
        Displacements and velocities at the start, from rest by default; or the ``end_state`` of the
        result for a record before, which then goes on.

    Returns
    -------
    xarray.Dataset
        Over ``time`` [s]: ``displacement`` [m] and ``velocity`` [m/s], relative to the ground;
        ``radius`` [m], ``sqrt(u^2 + (u'/w)^2)`` of eq. (1); and energies per unit mass [m^2/s^2]:
        ``input_energy_per_mass``, ``-Int a_g u' dt`` up to this time with the energy at the start;
        ``viscous_energy_per_mass`` and ``hysteretic_energy_per_mass``, dissipated up to this time;
        ``kinetic_energy_per_mass``, ``u'^2/2``; and ``elastic_energy_per_mass``, which unloading
        would release. The last four add up to the first. If the structure can yield, also ``z``
        [-], the hysteretic displacement over ``uy``, which is in [-1, 1] for the bilinear law.

        For a building with storeys, ``displacement`` and ``velocity`` are over ``floor``, and
        ``storey_drift`` [m] and ``z`` over ``element``; energies are those of all floors over the
        total mass, and there is no ``radius``. For all structures except `Bilinear`, the time steps
        are those of `simulate`, halved until no peak changes by more than 1e-4 relatively, and
        ``z`` at no time by more than 1e-4; ``step_error`` [-] is the last change, and the error
        about a third of it. If the structure falls (see `simulate`), histories are NaN from then
        on, and the attribute ``collapse_s`` is the time.

        Over ``state``, ``end_state``, from which ``start`` goes on, with a record that begins with
        the last sample of the one before. The histories of two records are then those of one record
        of both. They have the same bits for `Bilinear`, and with ``refine`` of 1 for all structures
        if their time steps are the same.

    Raises
    ------
    ValueError, TypeError
        If the structure has arrays or a reduction factor, the record is not valid, ``refine`` is
        not a whole number from 1, or the start has another number of values, yields, or is of
        another structure or of one that has fallen.
    ArithmeticError
        If the response is not finite, as with a law whose states run away.

    Warns
    -----
    UserWarning
        If the response has not converged after ten halvings; ``step_error`` is then above 1e-4.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (5) to (7); Uang, C.-M. and Bertero, V. V.
    (1990), Earthquake Eng. Struct. Dyn. 19, for the relative input energy.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> time = 0.02 * np.arange(500)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> building = sl.Bilinear(period=1.0, damping=0.05, hardening=0.05, yield_displacement=0.02)
    >>> motion = sl.respond(building, record, refine=4)
    >>> motion.sizes["time"], float(abs(motion.z).max())
    (1997, 1.0)
    """
    check_scalars(structure, "structure", ONE_STRUCTURE)
    if not isinstance(record, xr.DataArray):
        raise TypeError(f"record is a {type(record).__name__}; allowed: one xarray.DataArray")
    motions = checked_motions(record, may_be_still=start is not None)
    arguments = {"function": "respond", "structure": structure.describe()}
    check_arguments(start, arguments)
    if isinstance(start, xr.DataArray) and start.isnull().any():
        what = f"start has NaN, as the {END_STATE} of a motion in which the structure falls"
        raise ValueError(f"{what}; allowed: the {END_STATE} of one without a fall, or a Start")
    [ground] = motions.grounds
    intervals = ground.acceleration.size - 1
    time = float(record["time"][0]) + ground.dt / refine * np.arange(refine * intervals + 1)
    time[::refine] = record["time"]
    if isinstance(structure, Bilinear):
        table = _exact_history(structure, motions, int(refine), start)
    else:
        table = stepped_history(structure, ground, int(refine), start)
    table = table.assign_coords(time=("time", time, {"units": "s", "long_name": "time"}))
    call = f"respond(refine={refine})"
    table = _until_fall(table, structure).assign_attrs(start_in_words(start))
    table = with_arguments(table, arguments)
    return _with_information(table, "Response to a record", call, structure, motions)


def _until_fall(table: xr.Dataset, structure: AnyStructure) -> xr.Dataset:
    """A history with NaN after the structure falls, and the time at which it does, if it does."""
    system = assembly_of([structure])
    drifts = table.storey_drift if structure.has_storeys else table.displacement
    fallen = system.fallen(drifts.values.reshape(table.time.size, -1), system.limits)[:, 0]
    if not fallen.any():
        return table
    falls = float(table.time[int(np.argmax(fallen))])
    histories = {
        n: v.where(table.time <= falls) for n, v in table.data_vars.items() if "time" in v.dims
    }
    histories[END_STATE] = xr.full_like(table[END_STATE], np.nan)
    return table.assign(histories).assign_attrs(collapse_s=falls)


@np.errstate(all="ignore")  # of structures that fall beyond all numbers
def _energies(parameters: Array, states: Array) -> tuple[Array, ...]:
    """The `ENERGIES_PER_MASS` of structures with parameters (..., 4) in states (..., STATE).

    They are in balance.
    """
    w, _, hardening, _ = parameters.T
    u, v, y, put_in, hysteretic = np.moveaxis(states, -1, 0)
    kinetic = 0.5 * v**2
    elastic = 0.5 * w**2 * (hardening * u**2 + (1 - hardening) * y**2)
    return put_in, put_in - hysteretic - kinetic - elastic, hysteretic, kinetic, elastic


def _exact_history(
    structure: Bilinear, motions: RecordedMotions, refine: int, start: AnyStart | None
) -> xr.Dataset:
    """The response history of a bilinear oscillator for `respond`; without times."""
    [[parameters]] = RecordCells.of(motions, structure).sides
    first = np.zeros(STATE_SIZE)
    if isinstance(start, Start):
        [u], [v] = start_values(assembly_of([structure]), start)
        first[:3] = u, v, u
        first[INPUT_ENERGY] = 0.5 * (v**2 + (parameters[0] * u) ** 2)
    elif start is not None:
        first = checked_end_state(start, STATE_SIZE)
    states = response(motions.grounds[0], parameters, refine, first)
    displacement, velocity, strain = states.T[:3]
    columns = {
        "displacement": displacement,
        "velocity": velocity,
        "radius": np.hypot(displacement, velocity / parameters[0]),
        **dict(zip(ENERGIES_PER_MASS, _energies(parameters, states), strict=True)),
    }
    if structure.yields:
        columns["z"] = strain / parameters[3]
    table = xr.Dataset({name: ("time", values) for name, values in columns.items()})
    return table.assign({END_STATE: as_end_state(states[-1])})


def _with_information(
    table: xr.Dataset, title: str, call: str, structure: AnyStructure, motions: RecordedMotions
) -> xr.Dataset:
    table = labels.label(table).assign_attrs(records=motions.describe())
    return labels.with_run_information(
        table, title, call, {"structure": structure}, RESPONSE_REFERENCES
    )
