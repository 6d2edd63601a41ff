"""Contacts of pounding structures: elements with a force law, and the stereomechanical impact.

Each element has its own relation between damping and coefficient of restitution. Eq. (15) of the
paper is the relation of `Kelvin` and holds for this element only.
"""
