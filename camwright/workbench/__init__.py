"""The workbench: a local page that shows a cam while it is drawn, proves it, and writes what the command line writes."""
