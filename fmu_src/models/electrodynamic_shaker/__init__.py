"""``ElectrodynamicShaker``: variable table, error texts, documentation and reference results."""
