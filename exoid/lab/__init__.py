"""Laboratory: replays of the documents, studies of many virtual legs, stability of the laws, and coordination."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submodules=["coordination", "reproduce", "stability", "study"]
)
