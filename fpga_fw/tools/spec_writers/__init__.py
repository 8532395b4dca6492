"""Writers of the files that generate_spec makes: one module per kind of file."""
