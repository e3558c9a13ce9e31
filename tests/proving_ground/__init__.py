"""Proving ground: machines drawn by seed, simulated by MuJoCo, with motions and controllers that exoid does not know.

Seeds below 1000 are for tuning, those from 1000 on for reporting. Nothing is tuned on a seed that is reported.
"""
