"""Pictures: fields, answers and their display in notebooks."""
