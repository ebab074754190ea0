"""Ports of methods to other languages: small cases, and what a port of them must and must not do."""
