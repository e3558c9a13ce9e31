"""A preparation for encoders that sometimes miss a count."""

from dataclasses import dataclass, replace

from scipy.ndimage import median_filter

from exoid.signals import ZeroPhase


@dataclass(frozen=True)
class Median(ZeroPhase):
    """The zero-phase preparation behind a median filter over the angles.

    Attributes:
        window: Samples that the median is of.
    """

    window: int = 3

    @property
    def name(self):
        return "median"

    def kinematics(self, recording):
        even = recording.resampled()
        return super().kinematics(replace(even, q=median_filter(even.q, (self.window, 1), mode="nearest")))

    def describe(self):
        return {**super().describe(), "window": self.window}
