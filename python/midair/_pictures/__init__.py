"""Pictures of fields, solutions and sequences, and their display in notebooks."""
