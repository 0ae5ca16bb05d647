raise SystemExit("a configuration that came with the sources was run")
