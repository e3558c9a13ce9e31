"""Low-pass filters: zero-phase, parallel (at the requested rows only), and moving average; rows without reversals."""
