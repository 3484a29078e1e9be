"""The command line: one file a verb, nothing but talking to the user."""
