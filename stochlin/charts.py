"""The charts in one place: functions that make their data, what draws them and the looks of curves.

``sl.charts.draw(sl.charts.restitution_chart())`` is Fig. 8.
"""

from stochlin.applications.figures.charts import CHARTS as CHARTS
from stochlin.applications.figures.charts import ChartSettings as ChartSettings
from stochlin.applications.figures.charts import chart_functions as chart_functions
from stochlin.applications.figures.charts import register_chart as register_chart
from stochlin.applications.figures.contacts import contact_history_chart as contact_history_chart
from stochlin.applications.figures.contacts import contact_loop_chart as contact_loop_chart
from stochlin.applications.figures.contacts import restitution_chart as restitution_chart
from stochlin.applications.figures.fig3 import effective_rules_chart as effective_rules_chart
from stochlin.applications.figures.fig3 import white_noise_chart as white_noise_chart
from stochlin.applications.figures.fig4 import period_ratio_chart as period_ratio_chart
from stochlin.applications.figures.fig5 import amplification_chart as amplification_chart
from stochlin.applications.figures.fig5 import period_plane_chart as period_plane_chart
from stochlin.applications.figures.fig9 import required_gap_chart as required_gap_chart
from stochlin.applications.figures.motions import energy_chart as energy_chart
from stochlin.applications.figures.motions import portrait_chart as portrait_chart
from stochlin.applications.figures.motions import recorded_gap_chart as recorded_gap_chart
from stochlin.messages import missing_in as _missing_in
from stochlin.views.figures.pictures import PICTURES as PICTURES
from stochlin.views.figures.pictures import draw as draw
from stochlin.views.pounding.pictures import draw_pound as draw_pound
from stochlin.views.sensitivity.tornado import draw_sensitivity as draw_sensitivity
from stochlin.views.separation.pictures import draw_heights as draw_heights
from stochlin.views.shared.style import CURVES as CURVES
from stochlin.views.shared.style import STYLE as STYLE
from stochlin.views.shared.style import ratio_ticks as ratio_ticks
from stochlin.views.shared.words import rule_label as rule_label
from stochlin.views.sites.pictures import draw_spectrum as draw_spectrum


def __getattr__(name: str) -> object:
    raise _missing_in(__name__, name)
