"""Effective properties by the secant rule, and eq. (4) with them."""

import stochlin as sl

sl.rules.rho_effective(
    1.0, 0.7, 0.05, 0.05, 0.05, 0.1, ductility_1=4.0, ductility_2=3.0, rule="secant"
).to_netcdf("answer.nc")
