"""The public names, each listed here and nowhere else, in the order in which a reader needs them.

They are imported when first used. Type checkers and editors read this list, and so does the reference
page: each of its sections shows what stands below the comment with its heading.
"""

__version__: str

# The solver
from .models.grounds import (
    WhiteNoise as WhiteNoise,
    KanaiTajimi as KanaiTajimi,
    CloughPenzien as CloughPenzien,
    ParallelGround as ParallelGround,
)
from .models.grounds.named import named_ground as named_ground
from .models.laws.bilinear import Bilinear as Bilinear
from .models.laws.bouc_wen import BoucWen as BoucWen
from .models.laws.baber_noori import BoucWenBaberNoori as BoucWenBaberNoori
from .models.laws.modified_clough import ModifiedClough as ModifiedClough
from .models.laws.flag import Flag as Flag
from .models.laws.hysteretic import Hysteretic as Hysteretic
from .models.buildings import (
    ShearBuilding as ShearBuilding,
    ModalBuilding as ModalBuilding,
)
from .models.links import Link as Link
from .analyses.linearization.systems.state_space import (
    statespace as statespace,
    stationary_covariance as stationary_covariance,
)
from .analyses.linearization.systems.coefficients import (
    equivalent_coefficients as equivalent_coefficients,
)
from .analyses.linearization.systems.systems import linearize_system as linearize_system
from .analyses.linearization.linearization import linearize as linearize
from .analyses.correlation.correlation import correlate as correlate
from .analyses.simulation.simulation import simulate as simulate
from .analyses.correlation.amplification import amplification as amplification

# More of the response
from .analyses.correlation.correlation import rho_white_noise as rho_white_noise
from .analyses.linearization.transient_response import transient_response as transient_response
from .analyses.linearization.peaks import peak_response as peak_response
from .analyses.linearization.strength import (
    reduction_factor as reduction_factor,
    strength_for_ductility as strength_for_ductility,
)
from .analyses.loops import hysteresis_loop as hysteresis_loop
from .analyses.simulation.ground_motions import simulated_motions as simulated_motions
from .analyses.simulation.finite_motions import exceedance as exceedance

# The gap
from .analyses.separation.separation import separation as separation
from .analyses.separation.critical_gap import critical_gap as critical_gap
from .analyses.separation.existing_gap import existing_gap as existing_gap
from .analyses.separation.energy_gap import energy_gap as energy_gap
from .analyses.separation.added_damping import damping_for_gap as damping_for_gap
from .analyses.separation.code_gaps import code_gaps as code_gaps
from .analyses.sensitivity.sensitivity import sensitivity as sensitivity
from .models.uncertain import Uncertain as Uncertain
from .analyses.cases.reading.case import read_case as read_case
from . import rules as rules

# Records and envelopes
from .analyses.records.records import read_record as read_record
from .analyses.sites.suites import (
    read_records as read_records,
    scale_records as scale_records,
)
from .analyses.sites.ground_fit import fit_ground as fit_ground
from .analyses.sites.motion_fit import fit_motion as fit_motion
from .analyses.records.envelope_fit import fit_envelope as fit_envelope
from .models.envelopes import (
    AminAng as AminAng,
    ShinozukaSato as ShinozukaSato,
    GammaEnvelope as GammaEnvelope,
)
from .analyses.records.response import (
    respond as respond,
    response_spectrum as response_spectrum,
    pseudo_energy_radius as pseudo_energy_radius,
)
from .analyses.records.gaps import recorded_gap as recorded_gap

# Spectra and hazards of a site
from .analyses.sites.design_spectra import (
    eurocode_8 as eurocode_8,
    asce_7 as asce_7,
)
from .analyses.sites.spectra import read_spectrum as read_spectrum
from .analyses.sites.intensity import scale_ground as scale_ground
from .analyses.sites.hazard_files import read_hazard as read_hazard
from .models.hazards import (
    HazardCurve as HazardCurve,
    PowerLawHazard as PowerLawHazard,
)

# Buildings from files
from .analyses.buildings.modes import read_modes as read_modes
from .analyses.buildings.pushover_files import read_pushover as read_pushover
from .analyses.buildings.pushover import bilinear_of as bilinear_of

# Probability and risk
from .analyses.probability.probability import pounding_probability as pounding_probability
from .analyses.probability.fragility import pounding_fragility as pounding_fragility
from .analyses.risk.risk import (
    pounding_risk as pounding_risk,
    required_gap as required_gap,
)

# Impacts
from .analyses.pounding.pounding import pound as pound
from .analyses.pounding.estimates import pounding_estimate as pounding_estimate
from .models.contacts import (
    LinearSpring as LinearSpring,
    Kelvin as Kelvin,
    NoTensionKelvin as NoTensionKelvin,
    ImpactKelvin as ImpactKelvin,
    Hertz as Hertz,
    HertzDamp as HertzDamp,
    Jankowski as Jankowski,
    Stereomechanical as Stereomechanical,
)

# Measures against pounding
from .models.measures import Measure as Measure
from .analyses.mitigation.mitigation import mitigate as mitigate

# Charts
from . import charts as charts
