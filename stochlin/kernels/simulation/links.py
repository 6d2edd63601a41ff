"""Largest forces of links in simulated motions, and the energies that they dissipate.

The extension of a link is known after each step, and its rate is constant within a step. The change of
the extension therefore gives the mean force of a dashpot and the slip of a spring that yields, which are
those of the step itself, as in `account`.
"""

from __future__ import annotations

from typing import NamedTuple

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.simulation.stepping import LANES, turned

POST, COUPLE, STRENGTH, CONSTANT, EXPONENT = range(5)  # columns of the parameters of a link


class LinkPeaks(NamedTuple):
    """What is known of each of l links after so many steps, in each motion."""

    extension: Array  # (l, LANES) ``u1 - u2`` [m]
    elastic: Array  # (l, LANES) its elastic part [m]
    force: Array  # (l, LANES) largest force, as means of steps [N]
    energy: Array  # (l, LANES) dissipated so far [J]
    way: Array  # (l, LANES) rate of the extension times the time step [m]
    stroke: Array  # (l, LANES) largest absolute extension, also where it turns within a step [m]


@entry
def watch_links(extensions, parameters, dt, peaks):
    """Update the peaks of links by their extensions after each step (steps, l, LANES).

    The columns of ``parameters`` (l, 5) are those of this module.
    """
    extension, elastic, force, energy, way, stroke = peaks
    for s in range(extensions.shape[0]):
        for i in range(len(parameters)):
            post, couple, strength = parameters[i, POST], parameters[i, COUPLE], parameters[i, STRENGTH]
            c, a = parameters[i, CONSTANT], parameters[i, EXPONENT]
            for lane in range(LANES):
                begin, end, z = extension[i, lane], extensions[s, i, lane], elastic[i, lane]
                change = end - begin
                new = min(max(z + change, -strength), strength)
                slip = change - (new - z)
                held = 0.5 * couple * (z + new)
                rate = abs(change) / dt
                drag = c * (rate if a == 1.0 else rate**a)
                mean = 0.5 * post * (begin + end) + held + (drag if change > 0.0 else -drag)
                extension[i, lane], elastic[i, lane] = end, new
                force[i, lane] = max(force[i, lane], abs(mean))
                energy[i, lane] += drag * abs(change) + held * slip
                turn, way[i, lane] = turned(begin, end, way[i, lane])
                stroke[i, lane] = max(stroke[i, lane], abs(turn), abs(end))
