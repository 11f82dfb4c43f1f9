"""Boards: the bytes that make them play, and the links that carry these."""
