"""Measures this project: retrieval, latency, servers, builds, Blender, the verifier and audits."""
