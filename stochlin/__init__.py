"""Correlation and separation of neighbouring yielding buildings.

Random vibration of neighbouring bilinear hysteretic buildings by statistical linearization.
The public names are listed in ``__all__`` and imported when first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stochlin.analyses.amplification import amplification
    from stochlin.analyses.atlas import open_atlas, write_atlas
    from stochlin.analyses.atlas_lookup import lookup
    from stochlin.analyses.case_files import example_case, read_case
    from stochlin.analyses.code_gaps import code_gaps
    from stochlin.analyses.correlation import correlate, rho_white_noise
    from stochlin.analyses.critical_gaps import critical_gap
    from stochlin.analyses.effective_correlation import rho_effective
    from stochlin.analyses.envelope_fit import energy_build_up, fit_envelope
    from stochlin.analyses.evolutionary_spectra import evolutionary_psd
    from stochlin.analyses.existing_gaps import existing_gap
    from stochlin.analyses.finite_motions import exceedance
    from stochlin.analyses.fragility import pounding_fragility
    from stochlin.analyses.ground_fit import fit_ground
    from stochlin.analyses.linearization import linearize
    from stochlin.analyses.linked import correlate_linked
    from stochlin.analyses.mitigation import mitigate
    from stochlin.analyses.peaks import peak_response
    from stochlin.analyses.pounding import pound
    from stochlin.analyses.pounding_estimates import pounding_estimate
    from stochlin.analyses.pounding_probability import pounding_probability
    from stochlin.analyses.record_spectra import fit_spectra
    from stochlin.analyses.recorded_gaps import recorded_gap
    from stochlin.analyses.recorded_response import pseudo_energy_radius, respond, response_spectrum
    from stochlin.analyses.records import read_record, strong_part
    from stochlin.analyses.separation import separation
    from stochlin.analyses.simulation import simulate
    from stochlin.analyses.state_space import statespace, stationary_covariance
    from stochlin.analyses.strength import reduction_factor, strength_for_ductility
    from stochlin.analyses.transient_response import transient_response
    from stochlin.models.buildings import ShearBuilding
    from stochlin.models.code_rules import code_rule, code_rule_names
    from stochlin.models.contacts import (
        Hertz,
        HertzDamp,
        ImpactKelvin,
        Jankowski,
        Kelvin,
        LinearSpring,
        NoTensionKelvin,
        Stereomechanical,
    )
    from stochlin.models.effective_properties import effective_rule, effective_rule_names
    from stochlin.models.envelopes import AminAng, GammaEnvelope, HsuBernard, ShinozukaSato
    from stochlin.models.grounds import CloughPenzien, KanaiTajimi, WhiteNoise
    from stochlin.models.links import Link
    from stochlin.models.measures import Measure
    from stochlin.models.named_grounds import ground_names, named_ground
    from stochlin.models.peak_factors import peak_factor_model, peak_factor_names
    from stochlin.models.structures import Bilinear, BoucWen, Hysteretic

__version__ = "0.1.0"

# Imported when first used: a start of the command line then costs no more than it needs.
_HOME = {
    "AminAng": "models.envelopes",
    "Bilinear": "models.structures",
    "BoucWen": "models.structures",
    "CloughPenzien": "models.grounds",
    "GammaEnvelope": "models.envelopes",
    "Hertz": "models.contacts",
    "HertzDamp": "models.contacts",
    "HsuBernard": "models.envelopes",
    "Hysteretic": "models.structures",
    "ImpactKelvin": "models.contacts",
    "Jankowski": "models.contacts",
    "KanaiTajimi": "models.grounds",
    "Kelvin": "models.contacts",
    "LinearSpring": "models.contacts",
    "Link": "models.links",
    "Measure": "models.measures",
    "NoTensionKelvin": "models.contacts",
    "ShearBuilding": "models.buildings",
    "ShinozukaSato": "models.envelopes",
    "Stereomechanical": "models.contacts",
    "WhiteNoise": "models.grounds",
    "amplification": "analyses.amplification",
    "code_gaps": "analyses.code_gaps",
    "code_rule": "models.code_rules",
    "code_rule_names": "models.code_rules",
    "correlate": "analyses.correlation",
    "correlate_linked": "analyses.linked",
    "critical_gap": "analyses.critical_gaps",
    "effective_rule": "models.effective_properties",
    "effective_rule_names": "models.effective_properties",
    "energy_build_up": "analyses.envelope_fit",
    "evolutionary_psd": "analyses.evolutionary_spectra",
    "example_case": "analyses.case_files",
    "exceedance": "analyses.finite_motions",
    "existing_gap": "analyses.existing_gaps",
    "fit_envelope": "analyses.envelope_fit",
    "fit_ground": "analyses.ground_fit",
    "fit_spectra": "analyses.record_spectra",
    "ground_names": "models.named_grounds",
    "linearize": "analyses.linearization",
    "lookup": "analyses.atlas_lookup",
    "mitigate": "analyses.mitigation",
    "named_ground": "models.named_grounds",
    "open_atlas": "analyses.atlas",
    "peak_factor_model": "models.peak_factors",
    "peak_factor_names": "models.peak_factors",
    "peak_response": "analyses.peaks",
    "pound": "analyses.pounding",
    "pounding_estimate": "analyses.pounding_estimates",
    "pounding_fragility": "analyses.fragility",
    "pounding_probability": "analyses.pounding_probability",
    "pseudo_energy_radius": "analyses.recorded_response",
    "read_case": "analyses.case_files",
    "read_record": "analyses.records",
    "recorded_gap": "analyses.recorded_gaps",
    "reduction_factor": "analyses.strength",
    "respond": "analyses.recorded_response",
    "response_spectrum": "analyses.recorded_response",
    "rho_effective": "analyses.effective_correlation",
    "rho_white_noise": "analyses.correlation",
    "separation": "analyses.separation",
    "simulate": "analyses.simulation",
    "statespace": "analyses.state_space",
    "stationary_covariance": "analyses.state_space",
    "strength_for_ductility": "analyses.strength",
    "strong_part": "analyses.records",
    "transient_response": "analyses.transient_response",
    "write_atlas": "analyses.atlas",
}

__all__ = [
    "AminAng",
    "Bilinear",
    "BoucWen",
    "CloughPenzien",
    "GammaEnvelope",
    "Hertz",
    "HertzDamp",
    "HsuBernard",
    "Hysteretic",
    "ImpactKelvin",
    "Jankowski",
    "KanaiTajimi",
    "Kelvin",
    "LinearSpring",
    "Link",
    "Measure",
    "NoTensionKelvin",
    "ShearBuilding",
    "ShinozukaSato",
    "Stereomechanical",
    "WhiteNoise",
    "amplification",
    "code_gaps",
    "code_rule",
    "code_rule_names",
    "correlate",
    "correlate_linked",
    "critical_gap",
    "effective_rule",
    "effective_rule_names",
    "energy_build_up",
    "evolutionary_psd",
    "example_case",
    "exceedance",
    "existing_gap",
    "fit_envelope",
    "fit_ground",
    "fit_spectra",
    "ground_names",
    "linearize",
    "lookup",
    "mitigate",
    "named_ground",
    "open_atlas",
    "peak_factor_model",
    "peak_factor_names",
    "peak_response",
    "pound",
    "pounding_estimate",
    "pounding_fragility",
    "pounding_probability",
    "pseudo_energy_radius",
    "read_case",
    "read_record",
    "recorded_gap",
    "reduction_factor",
    "respond",
    "response_spectrum",
    "rho_effective",
    "rho_white_noise",
    "separation",
    "simulate",
    "statespace",
    "stationary_covariance",
    "strength_for_ductility",
    "strong_part",
    "transient_response",
    "write_atlas",
]


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'stochlin' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"stochlin.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *_HOME]
