"""Correlation and separation of neighbouring yielding buildings.

Random vibration of neighbouring bilinear hysteretic buildings by statistical linearization.
The public names are listed in ``__init__.pyi`` and imported when first used.
"""

from __future__ import annotations

import lazy_loader

from stochlin._version import __version__ as __version__

_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name not in __all__:
        from stochlin.messages import missing_in

        raise missing_in(__name__, name)
    return _find(name)
