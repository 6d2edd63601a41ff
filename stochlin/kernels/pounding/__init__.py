"""Response of a row of buildings to a recorded motion, with impacts; forces of contact elements."""
