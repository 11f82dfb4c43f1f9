"""Meshes: files of modellers, and the sound on their surfaces."""
