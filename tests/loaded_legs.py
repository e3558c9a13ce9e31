"""Legs that carry payloads."""

from exoid.torques.payloads import payload_parameters


def with_payloads(leg, payloads):
    """Fix payloads to a leg, so that its model includes them."""
    return leg.with_parameters(leg.parameters + payload_parameters(leg, payloads))
