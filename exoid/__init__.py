"""exoid: a URDF and a log go in; an identified leg you can trust, look at and control with comes out.

A name is imported when it is first used. The table of contents is ``__init__.pyi`` beside this file.
"""

import lazy_loader

from ._version import __version__ as __version__

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
