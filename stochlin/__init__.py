"""Correlation and separation of neighbouring yielding buildings.

Random vibration of neighbouring bilinear hysteretic buildings by statistical linearization.
The public names are listed in ``__all__`` and imported when first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from stochlin._version import __version__ as __version__

if TYPE_CHECKING:
    from stochlin.analyses.atlases.atlas import open_atlas, write_atlas
    from stochlin.analyses.atlases.lookup import lookup
    from stochlin.analyses.cases.case import example_case, read_case
    from stochlin.analyses.correlation.amplification import amplification
    from stochlin.analyses.correlation.correlation import correlate, rho_white_noise
    from stochlin.analyses.correlation.effective import rho_effective
    from stochlin.analyses.correlation.linked import correlate_linked
    from stochlin.analyses.linearization.linearization import linearize
    from stochlin.analyses.linearization.peaks import peak_response
    from stochlin.analyses.linearization.state_space import statespace, stationary_covariance
    from stochlin.analyses.linearization.strength import reduction_factor, strength_for_ductility
    from stochlin.analyses.linearization.transient_response import transient_response
    from stochlin.analyses.mitigation.mitigation import mitigate
    from stochlin.analyses.pounding.estimates import pounding_estimate
    from stochlin.analyses.pounding.pounding import pound
    from stochlin.analyses.probability.fragility import pounding_fragility
    from stochlin.analyses.probability.probability import pounding_probability
    from stochlin.analyses.records.envelope_fit import energy_build_up, fit_envelope
    from stochlin.analyses.records.evolutionary_spectra import evolutionary_psd
    from stochlin.analyses.records.gaps import recorded_gap
    from stochlin.analyses.records.ground_fit import fit_ground
    from stochlin.analyses.records.records import read_record, strong_part
    from stochlin.analyses.records.response import pseudo_energy_radius, respond, response_spectrum
    from stochlin.analyses.records.spectra import fit_spectra
    from stochlin.analyses.separation.code_gaps import code_gaps
    from stochlin.analyses.separation.critical_gap import critical_gap
    from stochlin.analyses.separation.existing_gap import existing_gap
    from stochlin.analyses.separation.separation import separation
    from stochlin.analyses.simulation.finite_motions import exceedance
    from stochlin.analyses.simulation.simulation import simulate
    from stochlin.models.buildings import ShearBuilding
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
    from stochlin.models.envelopes import AminAng, GammaEnvelope, HsuBernard, ShinozukaSato
    from stochlin.models.grounds import CloughPenzien, KanaiTajimi, WhiteNoise
    from stochlin.models.grounds.named import ground_names, named_ground
    from stochlin.models.laws.bilinear import Bilinear
    from stochlin.models.laws.bouc_wen import BoucWen
    from stochlin.models.laws.hysteretic import Hysteretic
    from stochlin.models.links import Link
    from stochlin.models.measures import Measure
    from stochlin.models.rules.codes import code_rule, code_rule_names
    from stochlin.models.rules.effective_properties import effective_rule, effective_rule_names
    from stochlin.models.rules.peak_factors import peak_factor_model, peak_factor_names


# Imported when first used: a start of the command line then costs no more than it needs.
_HOME = {
    "AminAng": "models.envelopes",
    "Bilinear": "models.laws.bilinear",
    "BoucWen": "models.laws.bouc_wen",
    "CloughPenzien": "models.grounds",
    "GammaEnvelope": "models.envelopes",
    "Hertz": "models.contacts",
    "HertzDamp": "models.contacts",
    "HsuBernard": "models.envelopes",
    "Hysteretic": "models.laws.hysteretic",
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
    "amplification": "analyses.correlation.amplification",
    "code_gaps": "analyses.separation.code_gaps",
    "code_rule": "models.rules.codes",
    "code_rule_names": "models.rules.codes",
    "correlate": "analyses.correlation.correlation",
    "correlate_linked": "analyses.correlation.linked",
    "critical_gap": "analyses.separation.critical_gap",
    "effective_rule": "models.rules.effective_properties",
    "effective_rule_names": "models.rules.effective_properties",
    "energy_build_up": "analyses.records.envelope_fit",
    "evolutionary_psd": "analyses.records.evolutionary_spectra",
    "example_case": "analyses.cases.case",
    "exceedance": "analyses.simulation.finite_motions",
    "existing_gap": "analyses.separation.existing_gap",
    "fit_envelope": "analyses.records.envelope_fit",
    "fit_ground": "analyses.records.ground_fit",
    "fit_spectra": "analyses.records.spectra",
    "ground_names": "models.grounds.named",
    "linearize": "analyses.linearization.linearization",
    "lookup": "analyses.atlases.lookup",
    "mitigate": "analyses.mitigation.mitigation",
    "named_ground": "models.grounds.named",
    "open_atlas": "analyses.atlases.atlas",
    "peak_factor_model": "models.rules.peak_factors",
    "peak_factor_names": "models.rules.peak_factors",
    "peak_response": "analyses.linearization.peaks",
    "pound": "analyses.pounding.pounding",
    "pounding_estimate": "analyses.pounding.estimates",
    "pounding_fragility": "analyses.probability.fragility",
    "pounding_probability": "analyses.probability.probability",
    "pseudo_energy_radius": "analyses.records.response",
    "read_case": "analyses.cases.case",
    "read_record": "analyses.records.records",
    "recorded_gap": "analyses.records.gaps",
    "reduction_factor": "analyses.linearization.strength",
    "respond": "analyses.records.response",
    "response_spectrum": "analyses.records.response",
    "rho_effective": "analyses.correlation.effective",
    "rho_white_noise": "analyses.correlation.correlation",
    "separation": "analyses.separation.separation",
    "simulate": "analyses.simulation.simulation",
    "statespace": "analyses.linearization.state_space",
    "stationary_covariance": "analyses.linearization.state_space",
    "strength_for_ductility": "analyses.linearization.strength",
    "strong_part": "analyses.records.records",
    "transient_response": "analyses.linearization.transient_response",
    "write_atlas": "analyses.atlases.atlas",
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
