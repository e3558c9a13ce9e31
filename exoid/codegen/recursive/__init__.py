"""Templates of the recursive estimator in C99; :mod:`exoid.online.in_c` fills them."""

__all__: list[str] = []
