"""Tools that know no robot: files, tables, JSON values, settings, registries, and the guarded reader process."""
