"""Stability of a worn leg: what the controller's model must know how well."""
