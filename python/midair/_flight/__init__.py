"""Flight: beads in the traps of a sequence."""
