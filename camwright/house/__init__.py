"""What every room of the front door needs: units, files, output, progress, provenance."""
