"""Pictures: fields, answers and what notebooks show."""
