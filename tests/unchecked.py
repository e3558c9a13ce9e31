"""Identification without the checks of log and fit, for tests of something else: checks cost more than the fit.

``tests/identification/findings`` tests the findings. A few tests of each kind of problem (arms, groups, poses, each
estimator, nonlinear terms) keep the checks on, so that these run there as well.
"""

from functools import partial

import exoid

identify = partial(exoid.identify, check=False)
