"""Laboratory: replays of the documents, studies of many virtual legs, and stability of the laws."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, submodules=["reproduce", "stability", "study"])
