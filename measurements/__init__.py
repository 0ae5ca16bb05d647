"""Measures this project: retrieval, signatures, latency, servers, builds, Blender, the verifier and audits."""
