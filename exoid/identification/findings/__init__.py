"""The log doctor: checks of logs and fits, each of which finds faults that would otherwise pass in silence."""

__all__: list[str] = []
