"""Process that reads files whose libraries can crash or fill the memory, with bounds on memory and time."""

from .bounds import most_memory, refuse_expansion, size_on_disk
from .child import Content, read_in_child

__all__ = ["Content", "most_memory", "read_in_child", "refuse_expansion", "size_on_disk"]
