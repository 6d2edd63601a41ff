"""What `simulate` reports of motions of finite duration; a file of this folder declares results."""

from stochlin.solver.simulation.results.result import (
    RESULTS,
    Column,
    EndedMotions,
    columns_of,
    descriptions,
    register_result,
)

__all__ = ["RESULTS", "Column", "EndedMotions", "columns_of", "descriptions", "register_result"]
