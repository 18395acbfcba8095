"""Registered heads: where they come from and how a set of them is built."""
