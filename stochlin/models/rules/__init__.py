"""What published formulas (rules) have in common: name, reference and mark, and the search by name.

The mark says how a formula was verified: S, compared with a copy of its source; P, in the available
text of Valles-Mattox and Reinhorn (1996); C, derived and checked here; M, not compared with its
source, with a high or a low confidence that the formula and its constants agree with it.
"""

from stochlin.models.rules.published import Published, Rule, look_up, publish

__all__ = ["Published", "Rule", "look_up", "publish"]
