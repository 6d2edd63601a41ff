"""Rules of codes and of the literature by name, as in ``sl.rules.code_rule("asce_7")``."""

from stochlin.messages import missing_in as _missing_in
from stochlin.models.rules.codes import code_rule as code_rule
from stochlin.models.rules.codes import code_rule_names as code_rule_names
from stochlin.models.rules.effective_properties import effective_rule as effective_rule
from stochlin.models.rules.effective_properties import effective_rule_names as effective_rule_names
from stochlin.models.rules.peak_factors import peak_factor_model as peak_factor_model
from stochlin.models.rules.peak_factors import peak_factor_names as peak_factor_names
from stochlin.solver.correlation.equation_4 import rho_effective as rho_effective


def __getattr__(name: str) -> object:
    raise _missing_in(__name__, name)
