"""Writes a scene in the language of each program."""
