"""Controllers that follow a reference, and such that carry a wearer's leg: one function for each."""

from __future__ import annotations

import numpy as np

from exoid._typing import ArrayLike
from exoid.tools.numbers import checked

from .friction import AHEAD, PASSIVE, FrictionCompensation, model_to_compensate
from .law import RATE, gains
from .model import ModelSource, possible_mass_matrix
from .tracking_law import TrackingLaw


def pd(kp: ArrayLike, kd: ArrayLike, *, rate: float = RATE) -> TrackingLaw:
    """Make PD control, τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) (doc. 2, eq. (24)), which needs no model.

    Args:
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad]; 0 for P control without damping (doc. 2, sec. III, sign corrected).
        rate: Sampling rate [Hz]; 30 in document 2.

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative or not finite, or the rate is not positive.

    Example:
        >>> import numpy as np
        >>> from exoid.control import State, pd
        >>> from exoid.rig import Target
        >>> law = pd(kp=(22.0, 56.0), kd=(2.2, 5.6))
        >>> law.torque(State(np.zeros(2), np.zeros(2)), Target(np.array([0.1, 0.2]), np.zeros(2)))
        array([ 2.2, 11.2])
    """
    return TrackingLaw("none", gains(kp, "kp"), gains(kd, "kd"), rate=rate)


def gravity_friction_pd(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> TrackingLaw:
    """Make PD with gravity and friction, τ = Kp (θ_d − θ) + Kd (θ̇_d − θ̇) + G(θ) + F_r(θ, θ̇_d) (doc. 2, eq. (25)).

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        friction: Friction compensation, in doc. 2 at the measured velocity (``SMOOTH``); None for gravity only.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative, or the source has no control model.

    Warns:
        UserWarning: The friction coefficients are negative: compensating them destabilises the leg.

    Example:
        >>> gravity_friction_pd(exoid.load_leg("cuhk"), kp=(22.0, 56.0), kd=(2.2, 5.6)).name
        'GravityFrictionPD'
    """
    model = model_to_compensate(source, friction)
    return TrackingLaw("gravity", gains(kp, "kp"), gains(kd, "kd"), model, friction, rate)


def feedforward_pd(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> TrackingLaw:
    """Make PD with feedforward of the reference, τ = Kp e + Kd ė + M(θ_d) θ̈_d + C(θ_d, θ̇_d) θ̇_d + G(θ_d) + F_r.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: Kp [N·m/rad], a number or one for each joint.
        kd: Kd [N·m·s/rad].
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative, or the source has no control model.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    model = model_to_compensate(source, friction)
    return TrackingLaw("reference", gains(kp, "kp"), gains(kd, "kd"), model, friction, rate)


def computed_torque(
    source: ModelSource,
    kp: ArrayLike,
    kd: ArrayLike,
    *,
    friction: FrictionCompensation | None = AHEAD,
    rate: float = RATE,
) -> TrackingLaw:
    """Make computed torque, τ = M(θ) [θ̈_d + kd (θ̇_d − θ̇) + kp (θ_d − θ)] + C(θ, θ̇) θ̇ + G(θ) + F_r.

    Args:
        source: An estimate, a leg, or a plant of one rig.
        kp: Gain [1/s²], the square of the natural frequency.
        kd: Gain [1/s], twice the natural frequency for critical damping.
        friction: Friction compensation; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A gain is negative, or the source has no control model.

    Warns:
        UserWarning: The friction coefficients are negative.
    """
    model = model_to_compensate(source, friction)
    possible_mass_matrix(model, np.zeros(model.n))
    return TrackingLaw("linearising", gains(kp, "kp"), gains(kd, "kd"), model, friction, rate)


def impedance(
    source: ModelSource,
    stiffness: ArrayLike,
    damping: ArrayLike,
    *,
    friction: FrictionCompensation | None = PASSIVE,
    rate: float = RATE,
) -> TrackingLaw:
    """Make impedance control, τ = K (θ_d − θ) + D (θ̇_d − θ̇) + M θ̈_d + C θ̇ + G + s + τ_f (Hogan 1985).

    With an exact model and e = θ_d − θ the wearer feels τ_wearer = −(M ë + D ė + K e): at rest a spring of stiffness K,
    whatever the weight. The inertia is that of the leg itself.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        stiffness: Stiffness K [N·m/rad], a number or one for each joint.
        damping: Damping D [N·m·s/rad].
        friction: Friction compensation, with a warning if it drives and is negative; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: Stiffness or damping is negative, or the source has no control model.

    Example:
        >>> impedance(exoid.load_leg("cuhk"), stiffness=(60.0, 40.0), damping=(6.0, 4.0)).rate
        100.0
    """
    kp, kd = gains(stiffness, "stiffness"), gains(damping, "damping")
    return TrackingLaw("measured", kp, kd, model_to_compensate(source, friction), friction, rate)


def gravity_support(
    source: ModelSource, share: ArrayLike = 1.0, *, friction: FrictionCompensation | None = None, rate: float = RATE
) -> TrackingLaw:
    """Make a controller that carries a share of the weight, τ = share · [G(q) + s(q)] + τ_f, springs included.

    With all of it and ``friction=PASSIVE`` the wearer feels neither weight nor friction: a transparent leg, but for its
    inertia, which :func:`sensitivity_amplification` reduces.

    Args:
        source: An estimate; a leg, which has no friction; or a plant of one rig, for an exact model.
        share: Share of the weight, 0 to 1, a number or one for each joint.
        friction: Friction compensation, with a warning if it drives and is negative; None for none.
        rate: Sampling rate [Hz].

    Returns:
        The controller.

    Raises:
        ExoidError: A share is not from 0 to 1, the rate is not positive, friction is that of a desired velocity, or the
            source has no control model.

    Example:
        >>> import numpy as np
        >>> leg = exoid.load_leg("cuhk")
        >>> law = gravity_support(leg, share=0.6)
        >>> state = exoid.control.State(np.array([0.5, 0.8]), np.zeros(2))
        >>> np.allclose(law.torque(state, None), 0.6 * leg.gravity([0.5, 0.8])[0])
        True
    """
    model = model_to_compensate(source, friction, follows=False)
    shares = checked(share, "the share of the weight", least=0.0, most=1.0)  # to carry the limb too, give its model
    return TrackingLaw("share", shares, np.zeros(()), model, friction, rate)
