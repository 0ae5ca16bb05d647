"""What several parts know of file formats: SARIF, HTML, .blend."""
