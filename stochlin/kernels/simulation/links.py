"""Largest forces of links in simulated motions, and the energies that they dissipate.

The extension of a link is known after each step, and its rate is constant within a step. The change
of the extension therefore gives the mean force of a dashpot and the slip of a spring that yields,
which are those of the step itself.
"""

from __future__ import annotations

from typing import NamedTuple

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.simulation.stepping import LANES, turned
from stochlin.kernels.simulation.time_step import COUPLE, POST, STRENGTH

CONSTANT, EXPONENT = 3, 4  # columns of the parameters of a link, after those of its spring


@borrowed
class LinkPeaks(NamedTuple):
    """The state and the peaks of each of l links after so many steps, in each motion."""

    extension: Array  # (l, LANES) ``u1 - u2`` [m]
    elastic: Array  # (l, LANES) its elastic part [m]
    force: Array  # (l, LANES) largest force, as means of steps [N]
    dissipated: Array  # (l, LANES) energy so far [J]
    way: Array  # (l, LANES) rate of the extension times the time step [m]
    stroke: Array  # (l, LANES) largest absolute extension, also where it turns within a step [m]


@entry
def watch_links(extensions, parameters, dt, peaks):
    """Update the peaks of links by their extensions after each step (steps, l, LANES).

    The columns of ``parameters`` (l, 5) are those of this module.
    """
    for s in range(extensions.shape[0]):
        for i in range(len(parameters)):
            post = parameters[i, POST]
            couple = parameters[i, COUPLE]
            strength = parameters[i, STRENGTH]
            c = parameters[i, CONSTANT]
            a = parameters[i, EXPONENT]
            extension = peaks.extension[i]
            elastic = peaks.elastic[i]
            force = peaks.force[i]
            dissipated = peaks.dissipated[i]
            way = peaks.way[i]
            stroke = peaks.stroke[i]
            for lane in range(LANES):
                begin = extension[lane]
                end = extensions[s, i, lane]
                z = elastic[lane]
                change = end - begin
                new = min(max(z + change, -strength), strength)
                slip = change - (new - z)
                spring = 0.5 * couple * (z + new)
                rate = abs(change) / dt
                drag = c * (rate if a == 1.0 else rate**a)
                mean = 0.5 * post * (begin + end) + spring + (drag if change > 0.0 else -drag)
                extension[lane] = end
                elastic[lane] = new
                force[lane] = max(force[lane], abs(mean))
                dissipated[lane] += drag * abs(change) + spring * slip
                turn, way[lane] = turned(begin, end, way[lane])
                stroke[lane] = max(stroke[lane], abs(turn), abs(end))
