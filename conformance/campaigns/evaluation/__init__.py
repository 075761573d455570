"""Evaluation of a campaign: charts against inputs, maps, and statistics of random designs."""
