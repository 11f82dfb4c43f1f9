"""Touch: the motion of a skin under a sequence, its felt strength, and sequences that feel strong."""
