"""Linear filter of each joint, over any number of consecutive samples."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are first used

from exoid._typing import FloatArray

LONGEST = 200_000
"""Samples after which an impulse response counts as over."""


@dataclass(frozen=True, eq=False)
class JointFilters:
    """Filter y = b(z) / a(z) x of order m of each joint, in transposed direct form II."""

    b: FloatArray  # numerators, powers of z⁻¹ rising, (m + 1, n)
    a: FloatArray  # denominators, the first coefficient 1, (m + 1, n)

    @classmethod
    def alike(cls, b: FloatArray, a: FloatArray, n: int) -> JointFilters:
        """Give every joint the same filter."""
        return cls(np.tile(b[:, None], n), np.tile(a[:, None], n))

    @property
    def order(self) -> int:
        """Order m."""
        return len(self.b) - 1

    def settled(self, x: FloatArray) -> FloatArray:
        """Make the memory after an input (..., n) that was constant for ever, (m, ..., n)."""
        y = self.b.sum(axis=0) / self.a.sum(axis=0) * x
        memory = np.zeros((self.order + 1, *x.shape))
        for k in range(self.order, 0, -1):
            memory[k - 1] = memory[k] + self.b[k] * x - self.a[k] * y
        return memory[:-1]

    def run(self, memory: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Filter consecutive samples (N, ..., n); also the memory after them."""
        if self._uniform:  # one call of SciPy for all joints: a step of one sample is mostly such calls
            y, after = scipy.signal.lfilter(self.b[:, 0], self.a[:, 0], x, axis=0, zi=memory)
            return y, after
        y, after = np.empty_like(x), np.empty_like(memory)
        for j, (b, a) in enumerate(zip(self.b.T, self.a.T, strict=True)):
            y[..., j], after[..., j] = scipy.signal.lfilter(b, a, x[..., j], axis=0, zi=memory[..., j])
        return y, after

    @cached_property
    def _uniform(self) -> bool:
        """Whether all joints have the same filter."""
        return bool((self.b == self.b[:, :1]).all() and (self.a == self.a[:, :1]).all())

    def response(self, frequency: float, rate: float) -> FloatArray:
        """Frequency response of each joint, (n,), complex."""
        delays = np.exp(-2j * np.pi * frequency / rate * np.arange(self.order + 1))
        return np.asarray((delays @ self.b) / (delays @ self.a))

    def impulse_response(self, x: FloatArray) -> FloatArray:
        """Filter a short input (k,) until the output is over."""
        radius = max(float(np.abs(np.roots(a)).max(initial=0.0)) for a in self.a.T)
        rings = LONGEST if radius >= 1.0 else int(np.ceil(-30.0 / np.log(max(radius, 1e-3))))  # to e⁻³⁰
        inputs = np.zeros((min(len(x) + rings, LONGEST), self.b.shape[1]))
        inputs[: len(x)] = x[:, None]
        return self.run(np.zeros((self.order, self.b.shape[1])), inputs)[0]
