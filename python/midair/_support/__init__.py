"""Support: what many packages need and nobody draws, holds or hears."""
