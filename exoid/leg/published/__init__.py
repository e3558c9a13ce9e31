"""Tables of both documents as data: values as printed, and assumptions.

>>> from exoid import published
>>> published.bleex().tables["V"].values["X1"]
Quantity(value=3.783, unit='kg·m', printed='3.783')
>>> published.bleex_parameters("left")["J1"]
2.38
"""

from .document import Assumption, Document, PublishedTable, bleex, cuhk
from .parameters import bleex_parameters, bleex_resistances, cuhk_cad_parameters, cuhk_parameters, cuhk_resistances

__all__ = [
    "Assumption",
    "Document",
    "PublishedTable",
    "bleex",
    "bleex_parameters",
    "bleex_resistances",
    "cuhk",
    "cuhk_cad_parameters",
    "cuhk_parameters",
    "cuhk_resistances",
]
