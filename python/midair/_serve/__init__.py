"""Serve: plays points that other programs on this machine send by WebSocket and OSC (`midair serve`)."""
