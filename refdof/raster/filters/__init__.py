"""Filters: mip chains, N-buffers and blends that methods share."""
