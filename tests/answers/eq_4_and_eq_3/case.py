"""The gap of eq. (3) with the correlation of eq. (4)."""

import stochlin as sl

table = sl.rho_white_noise(period_1=1.0, period_2=0.8, damping_1=0.05, damping_2=0.03)
table = table.merge(sl.critical_gap(0.12, 0.09, table.rho), compat="override")
table.to_netcdf("answer.nc")
