"""Campaigns: many runs with varied inputs."""
