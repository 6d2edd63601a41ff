"""Two elastic buildings with a spring and a dashpot between them."""

import stochlin as sl

office, annex = sl.Bilinear(1.0, 0.05, mass=4e5), sl.Bilinear(0.6, 0.03, mass=2e5)
link = sl.Link(stiffness=4e6, damping_constant=5e5)
table = sl.linearize_system([office, annex], sl.WhiteNoise(0.01), [link])
asked = ["displacement_std", "rho", "relative_displacement_std", "link_force_std"]
table[asked].to_netcdf("answer.nc")
