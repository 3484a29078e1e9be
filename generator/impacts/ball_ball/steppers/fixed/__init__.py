"""The fixed step: the scheme of pooltool and of the report, and its faster forms."""
