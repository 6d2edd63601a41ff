"""Two elastic buildings with a spring and a dashpot between them."""

import stochlin as sl

office, annex = sl.Bilinear(1.0, 0.05, mass=4e5), sl.Bilinear(0.6, 0.03, mass=2e5)
link = sl.Link(stiffness=4e6, damping_constant=5e5)
sl.correlate_linked(office, annex, sl.WhiteNoise(0.01), link).to_netcdf("answer.nc")
