"""Figures, functions of results that draw on matplotlib axes and return them, and the leg in three dimensions.

A name is imported when it is first used: the leg in three dimensions needs no matplotlib. The table of contents is
``__init__.pyi`` beside this file.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
