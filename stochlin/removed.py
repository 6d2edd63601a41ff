"""What was removed, by its bare name, and what to use instead.

A name is that of a function, class, keyword, value, command, option (``--json``) or key of a case file.
Whoever still uses it reads the clause in an error.
"""

OF_RULES = ["code_rule", "effective_rule", "peak_factor_model", "rho_effective"]
OF_RULES += ["code_rule_names", "effective_rule_names", "peak_factor_names"]
AMPLIFICATION = "peak over peak_alone of pound is the amplification"
LAZY = "parameters that are dask arrays give lazy tables, which .to_zarr() stores"
OTHERS = "compare with a structure of another period, stiffness or strength"
BUMPERS = "pound with the contact of the bumpers, and with the gap less their thickness"
REMOVED: dict[str, str] = {
    **{name: f"use rules.{name}" for name in OF_RULES},
    **dict.fromkeys(("amplification_limit", "mitigation"), AMPLIFICATION),
    **dict.fromkeys(("write_atlas", "atlas"), LAZY),
    **dict.fromkeys((f"{name}_{n}" for name in ("stiffening", "strengthening") for n in (1, 2)), OTHERS),
    **dict.fromkeys(("contact", "bumper_thickness"), BUMPERS),
    "example_case": "stochlin gap --example prints it",
    "fitted": "ModalBuilding takes the modes as they are",
    "evolutionary_psd": "it is envelope.at(time) ** 2 * ground.psd(frequency)",
    "open_atlas": "xarray.open_zarr() opens a stored table",
    "lookup": "xarray.open_zarr() opens a stored table, and .interp() interpolates in it",
    "pounding_estimate_row": "pounding_estimate for each two neighbours, or pound for the row",
    "pound_motions": "charts.pound_case(case, motions) simulates them",
    "draw_ensemble": "charts.draw_pound draws the results of many motions, too",
    "pounding_estimate_error": "pounding_estimate beside the amplification that pound gives in a motion",
    "ground_names": "the documentation of named_ground lists the names",
    "strong_part": "fit_ground(record, part=(0.05, 0.95)) takes this part of a record",
    "fit_spectra": "ground.psd(frequency), beside scipy.signal.welch of the record over 4 pi",
    "correlate_linked": "linearize_system([first, second], ground, links=[link]) has rho of all floors",
    "delivered_restitution": "the relations of the contact elements are exact: e is what was given",
    "energy_loss": "0.5 * (1 - e**2) * m1 * m2 / (m1 + m2) * (v1 - v2)**2 is lost in an impact",
    "simulated_spectrum": "use charts.simulated_spectrum",
    "FittedMotion": "fit_motion returns it",
    "compare_motions": "charts.simulated_spectrum of the fit beside response_spectrum of the record",
    "energy_build_up": "fit_envelope, beside (a**2).cumsum() / (a**2).sum() of a record a",
    "HsuBernard": "GammaEnvelope(1, 1 / peak_time) is the same envelope",
    "hsu_bernard": "gamma with a power of 1 is the same envelope",
    "verify": "stochlin charts draws simulation beside linearization, at --simulated-points",
    "verify_chart": "chart_functions has charts with simulation beside linearization",
    "to_at2": 'record.to_series().to_csv("motion.csv") writes a file that read_record reads',
    "bias_map": "linearize and correlate have bias, against the drift closure",
    "narrow_band": "closure='gaussian', or 'drift', which keeps the plastic drift",
    "damage": "peaks over yield displacements are ductilities; collapse_probability says who falls",
    "slack": "a contact of pound acts where a gap has closed, and a link without slack always",
    "per_spectrum_chart": "pseudo_energy_radius over periods has the spectrum",
    "draw_floors": 'peak_acceleration.plot(y="floor_level") and its likes draw a result of pound',
    "added_damping_chart": "damping_for_gap gives the gap over added damping, which .plot draws",
    "system": "no number depends on it; the page on buildings says what a chain leaves out of a wall",
    "strength_factor": "multiply the yield drifts",
    "parallel": "ParallelGround in Python, or a site by its spectrum, has several grounds",
    "--law": "stochlin.correlate of the library takes structures of any law",
    "solver": "linearize_system([first, second], ground).rho is by the full Lyapunov equation",
    "--solver": "stochlin.linearize_system has the tables of the full Lyapunov equation",
    "--record": "fit_ground, correlate and the charts of a record are functions of the library",
    "--yield-displacement": "yield_displacement= of the structures of stochlin.correlate",
    "--intensity": "intensity= of the ground of stochlin.correlate",
    "--structure-period": "period= of stochlin.charts.portrait_chart and energy_chart",
    "--sensitivity": "the page of a case with uncertain parameters, or charts.draw_sensitivity",
    "simulated_rho": "simulate has the rho of both structures, for critical_gap with the peaks",
    "--jobs": "stochlin warmup takes all cores",
}


def instead_of(name: str) -> str:
    """What an error says about a removed name, before what is allowed; empty for all other names."""
    return f"it was removed: {REMOVED[name]}; " if name in REMOVED else ""
