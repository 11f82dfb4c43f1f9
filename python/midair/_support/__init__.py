"""Support: helper functions for several packages."""
