"""Two elastic buildings on a soft site."""

import stochlin as sl

site = sl.KanaiTajimi(period=0.8, damping=0.2, intensity=0.01)
office, annex = sl.Bilinear(period=1.0, damping=0.05), sl.Bilinear(period=0.6, damping=0.02)
sl.correlate(office, annex, site).to_netcdf("answer.nc")
