"""The inputs of hostile.py: a module for each kind."""
