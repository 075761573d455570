"""Time integration: Newmark steps of wires, connectors, contacts and modal dampers."""
