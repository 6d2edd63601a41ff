"""The public names, each listed here and nowhere else, in the order in which a reader needs them.

They are imported when first used. Type checkers and editors read this list, and so does the
reference page: each of its sections shows what stands below the comment with its heading.
"""

__version__: str

# The solver
from .models.grounds import (
    WhiteNoise as WhiteNoise,
    KanaiTajimi as KanaiTajimi,
    CloughPenzien as CloughPenzien,
    ParallelGround as ParallelGround,
    named_ground as named_ground,
)
from .models.laws.bilinear import Bilinear as Bilinear
from .models.laws.bouc_wen import BoucWen as BoucWen
from .models.laws.baber_noori import BoucWenBaberNoori as BoucWenBaberNoori
from .models.laws.modified_clough import ModifiedClough as ModifiedClough
from .models.laws.flag import Flag as Flag
from .models.laws.hysteretic import Hysteretic as Hysteretic
from .models.buildings.shear import ShearBuilding as ShearBuilding
from .models.buildings.modal import ModalBuilding as ModalBuilding
from .models.links import Link as Link
from .solver.linearization.systems.state_space import (
    statespace as statespace,
    stationary_covariance as stationary_covariance,
)
from .solver.linearization.systems.coefficients import (
    equivalent_coefficients as equivalent_coefficients,
)
from .solver.linearization.systems.systems import linearize_system as linearize_system
from .solver.linearization.linearization import linearize as linearize
from .solver.correlation.correlation import correlate as correlate
from .solver.simulation.simulation import simulate as simulate
from .models.start import Start as Start
from .solver.correlation.amplification import amplification as amplification

# More of the response
from .solver.correlation.equation_4 import rho_white_noise as rho_white_noise
from .solver.linearization.transient_response import transient_response as transient_response
from .solver.linearization.peaks import peak_response as peak_response
from .solver.linearization.strength import (
    reduction_factor as reduction_factor,
    strength_for_ductility as strength_for_ductility,
)
from .solver.loops import hysteresis_loop as hysteresis_loop
from .solver.simulation.ground_motions import simulated_motions as simulated_motions
from .solver.simulation.statistics import exceedance as exceedance

# The gap
from .applications.separation.separation import separation as separation
from .applications.separation.passage_gap import passage_gap as passage_gap
from .applications.separation.critical_gap import critical_gap as critical_gap
from .applications.separation.existing_gap import existing_gap as existing_gap
from .applications.separation.energy_gap import energy_gap as energy_gap
from .applications.separation.energy_gap import damping_for_gap as damping_for_gap
from .applications.separation.code_gaps import code_gaps as code_gaps
from .applications.sensitivity.sensitivity import sensitivity as sensitivity
from .models.uncertain import Uncertain as Uncertain
from .applications.cases.reading.case import read_case as read_case
from .applications.cases.separation import separation_case as separation_case
from .solver.tables.dictionaries import as_dictionary as as_dictionary
from . import rules as rules

# Records and envelopes
from .applications.records.records import read_record as read_record
from .applications.sites.suites import (
    read_records as read_records,
    scale_records as scale_records,
)
from .applications.sites.ground_fit import fit_ground as fit_ground
from .applications.sites.motion_fit import fit_motion as fit_motion
from .applications.records.envelope_fit import fit_envelope as fit_envelope
from .models.envelopes import (
    AminAng as AminAng,
    ShinozukaSato as ShinozukaSato,
    GammaEnvelope as GammaEnvelope,
)
from .applications.records.response import (
    respond as respond,
    response_spectrum as response_spectrum,
    pseudo_energy_radius as pseudo_energy_radius,
)
from .applications.records.gaps import recorded_gap as recorded_gap

# Spectra and hazards of a site
from .applications.sites.design_spectra import (
    eurocode_8 as eurocode_8,
    asce_7 as asce_7,
)
from .applications.sites.spectra import read_spectrum as read_spectrum
from .applications.sites.simulated_spectra import simulated_spectrum as simulated_spectrum
from .applications.sites.intensity import scale_ground as scale_ground
from .applications.sites.hazard_files import read_hazard as read_hazard
from .models.hazards import (
    HazardCurve as HazardCurve,
    PowerLawHazard as PowerLawHazard,
)

# Buildings from files
from .applications.buildings.modes import read_modes as read_modes
from .applications.buildings.pushover import read_pushover as read_pushover
from .applications.buildings.pushover import bilinear_of as bilinear_of

# Probability and risk
from .applications.probability.probability import pounding_probability as pounding_probability
from .applications.probability.fragility import pounding_fragility as pounding_fragility
from .applications.risk.risk import (
    pounding_risk as pounding_risk,
    required_gap as required_gap,
)

# Impacts
from .applications.pounding.pounding import pound as pound
from .applications.cases.pounding import pound_case as pound_case
from .applications.pounding.estimates import pounding_estimate as pounding_estimate
from .models.walls import Wall as Wall
from .models.contacts.elements import (
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
from .applications.mitigation.mitigation import mitigate as mitigate

# Charts
from . import charts as charts

# Warnings
from .messages import (
    DoubtfulInput as DoubtfulInput,
    ImplausibleInput as ImplausibleInput,
)
