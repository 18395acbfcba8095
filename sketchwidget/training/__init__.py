"""Trains what the other rooms load, evaluates it, and writes the shipped files."""
